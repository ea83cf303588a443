// SPDX-License-Identifier: MIT
// Camera and projection, in double precision up to the last moment. Depth is reversed: 1 at the
// near plane, 0 at the far plane, which keeps 32-bit floats precise far away.
#include "image/view.h"

#include <fmt/format.h>
#include <isorast/error.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace isorast {

namespace {

using glm::dmat3;
using glm::dmat4;
using glm::dvec3;
using glm::dvec4;

constexpr uint32_t LARGEST_SIDE = 16384;

// Colour-blind safe and calm (after Okabe and Ito): bone first.
constexpr std::array<Color, 8> PALETTE{{{0.89f, 0.80f, 0.66f, 1},
                                        {0.34f, 0.63f, 0.83f, 1},
                                        {0.87f, 0.45f, 0.30f, 1},
                                        {0.28f, 0.64f, 0.47f, 1},
                                        {0.78f, 0.55f, 0.74f, 1},
                                        {0.93f, 0.78f, 0.33f, 1},
                                        {0.40f, 0.45f, 0.70f, 1},
                                        {0.60f, 0.60f, 0.60f, 1}}};

// An eye's axes and its half extents at unit view depth (perspective) or everywhere (orthographic).
// The middle of its picture moves by `shift` along `right` for each unit of view depth: 0 for one
// eye, while two look the same way and see the same at the distance of convergence.
struct Eye {
    dvec3 position, forward, right, up;
    double half_width = 1, half_height = 1, near = 0, far = 1, shift = 0;
    bool orthographic = false;
};

dvec3 to_vec(const std::array<double, 3>& v) {
    return {v[0], v[1], v[2]};
}

Eye make_eye(const Camera& camera, Size size) {
    Eye eye;
    eye.position = to_vec(camera.position);
    eye.forward = glm::normalize(to_vec(camera.target) - eye.position);
    eye.right = glm::normalize(glm::cross(eye.forward, to_vec(camera.up)));
    eye.up = glm::cross(eye.right, eye.forward);
    eye.orthographic = camera.orthographic;
    const double aspect = double(size.width) / size.height;
    const double half = camera.orthographic ? 0.5 * camera.height
                                            : std::tan(0.5 * glm::radians(camera.fov_degrees));
    eye.half_width = half * std::max(1.0, aspect);
    eye.half_height = half * std::max(1.0, 1 / aspect);
    return eye;
}

// One eye of two: an offset along the right axis, and a frustum that is not symmetric.
Eye moved(Eye eye, const Frame& frame, int side) {
    const double distance =
        glm::length(to_vec(frame.camera.target) - to_vec(frame.camera.position));
    const double convergence = frame.stereo.convergence.value_or(distance);
    const double offset = 0.5 * side * frame.stereo.separation.value_or(convergence / 30);
    eye.position += offset * eye.right;
    eye.shift = -offset / convergence;
    return eye;
}

dmat4 world_from_voxel(const Affine& affine, double unit) {
    dmat4 m(1);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            m[column][row] = affine.m[row][column] / unit;
    return m;
}

double power_of_two_below(double number) {
    return std::ldexp(1.0, std::ilogb(number));
}

// Lengths in other units.
Frame in_units(Frame frame, double unit) {
    for (int axis = 0; axis < 3; ++axis) {
        frame.camera.position[axis] /= unit;
        frame.camera.target[axis] /= unit;
    }
    frame.camera.height /= unit;
    for (auto* length : {&frame.stereo.separation, &frame.stereo.convergence})
        if (*length) **length /= unit;
    for (ClipPlane& clip : frame.clips)
        clip.offset /= unit;
    return frame;
}

// Near and far enclose the volume's box, a little widened; the near plane stays in front of the
// eye.
void fit_depth(Eye& eye, const dmat4& world, const std::array<uint32_t, 3>& dims) {
    double low = INFINITY, high = -INFINITY;
    for (int c = 0; c < 8; ++c) {
        const dvec4 corner(c & 1 ? dims[0] - 1 : 0, c & 2 ? dims[1] - 1 : 0,
                           c & 4 ? dims[2] - 1 : 0, 1);
        const double depth = glm::dot(dvec3(world * corner) - eye.position, eye.forward);
        low = std::min(low, depth);
        high = std::max(high, depth);
    }
    const double margin =
        std::max(1e-3 * (high - low), 1e-6 * std::max(std::abs(low), std::abs(high)));
    eye.near = low - margin;
    eye.far = high + margin;
    if (eye.far <= eye.near) eye.far = eye.near + 1;
    if (eye.orthographic) return;
    if (eye.far <= 0) eye.far = 1;  // the whole volume is behind the eye
    eye.near = std::max(eye.near, 1e-4 * eye.far);
}

dmat4 clip_from_world(const Eye& eye) {
    const auto row = [&](const dvec3& axis, double scale) {
        return dvec4(axis * scale, -glm::dot(axis, eye.position) * scale);
    };
    const dvec4 depth = row(eye.forward, 1), one(0, 0, 0, 1);
    const dvec4 x = row(eye.right, 1 / eye.half_width) - depth * (eye.shift / eye.half_width);
    const dvec4 y = row(eye.up, -1 / eye.half_height);
    const double range = eye.far - eye.near;
    const dvec4 z = eye.orthographic ? (eye.far * one - depth) / range
                                     : (eye.near * eye.far * one - eye.near * depth) / range;
    return glm::transpose(dmat4(x, y, z, eye.orthographic ? one : depth));
}

void set_rays(shared::EyeInfo& info, const Eye& eye, const dmat4& voxel) {
    const dmat3 linear(voxel);
    const dvec3 x = linear * eye.right * eye.half_width, y = -(linear * eye.up * eye.half_height);
    const dvec3 none(0), forward = linear * (eye.forward + eye.shift * eye.right);
    const auto pad = [](const dvec3& v) { return glm::vec4(glm::vec3(v), 0); };
    info.ray_origin = pad(dvec3(voxel * dvec4(eye.position, 1)));
    info.ray_direction = pad(forward);
    info.ray_origin_x = pad(eye.orthographic ? x : none);
    info.ray_origin_y = pad(eye.orthographic ? y : none);
    info.ray_direction_x = pad(eye.orthographic ? none : x);
    info.ray_direction_y = pad(eye.orthographic ? none : y);
}

void set_planes(shared::EyeInfo& info, const dmat4& clip) {
    const dmat4 rows = glm::transpose(clip);
    for (int axis = 0; axis < 2; ++axis) {
        info.planes[2 * axis] = glm::vec4(rows[3] + rows[axis]);
        info.planes[2 * axis + 1] = glm::vec4(rows[3] - rows[axis]);
    }
    info.planes[4] = glm::vec4(rows[2]);            // far
    info.planes[5] = glm::vec4(rows[3] - rows[2]);  // near
}

// Clip planes as the world has them, in voxel space and as each eye sees them. A plane is a row: it
// follows the inverse matrix.
void set_clips(shared::FrameInfo& info, const Frame& frame, const dmat4& world,
               const std::vector<dmat4>& clip_from_voxel) {
    for (size_t i = 0; i < frame.clips.size(); ++i) {
        const dvec3 normal = to_vec(frame.clips[i].normal);
        const dvec4 plane = dvec4(normal, -frame.clips[i].offset) / glm::length(normal) * world;
        info.clips[i] = glm::vec4(plane);
        for (size_t eye = 0; eye < clip_from_voxel.size(); ++eye)
            info.eyes[eye].clips[i] = glm::vec4(plane * glm::inverse(clip_from_voxel[eye]));
    }
}

void set_surfaces(shared::FrameInfo& info, const Frame& frame, const Stored& stored) {
    for (size_t i = 0; i < frame.isovalues.size(); ++i) {
        const Color& color =
            i < frame.colors.size() ? frame.colors[i] : PALETTE[i % PALETTE.size()];
        info.surfaces[i] = {color.r, color.g, color.b, stored.from_value(frame.isovalues[i])};
    }
}

void check_clips(const Frame& frame) {
    if (frame.clips.size() > shared::MAX_CLIPS)
        throw Error(fmt::format("clip planes: at most {}, found {}", shared::MAX_CLIPS,
                                frame.clips.size()));
    for (const ClipPlane& clip : frame.clips) {
        const double length = glm::length(to_vec(clip.normal));
        if (!(length > 0) || !std::isfinite(length) || !std::isfinite(clip.offset))
            throw Error(
                "clip planes: expected a finite normal that is not zero, and a finite offset");
    }
}

void check(const Stereo& stereo) {
    const auto is_length = [](const std::optional<double>& value) {
        return !value || (std::isfinite(*value) && *value > 0);
    };
    if (!is_length(stereo.separation) || !is_length(stereo.convergence))
        throw Error("stereo: expected a positive eye separation and convergence distance");
}

}  // namespace

void check(const Frame& frame) {
    const auto [width, height] = frame.size;
    if (width == 0 || height == 0 || width > LARGEST_SIDE || height > LARGEST_SIDE)
        throw Error(fmt::format("picture: expected a size of 1x1 to {0}x{0}, found {1}x{2}",
                                LARGEST_SIDE, width, height));
    if (frame.isovalues.size() > shared::MAX_SURFACES)
        throw Error(fmt::format("isovalues: at most {} in one picture, found {}",
                                shared::MAX_SURFACES, frame.isovalues.size()));
    for (double isovalue : frame.isovalues)
        if (!std::isfinite(isovalue))
            throw Error("isovalues: expected finite numbers, found NaN or infinity");
    const Camera& camera = frame.camera;
    const dvec3 forward = to_vec(camera.target) - to_vec(camera.position);
    const double across = glm::length(glm::cross(forward, to_vec(camera.up)));
    if (!(across > 1e-9 * glm::length(forward) * glm::length(to_vec(camera.up))))
        throw Error(
            "camera: position and target must differ, and up must not lie along the viewing "
            "direction");
    if (!camera.orthographic && !(camera.fov_degrees > 0 && camera.fov_degrees < 180))
        throw Error(
            fmt::format("camera: expected a field of view between 0 and 180 degrees, found {}",
                        camera.fov_degrees));
    if (camera.orthographic && !(camera.height > 0))
        throw Error(fmt::format("camera: expected a positive orthographic height, found {}",
                                camera.height));
    check_clips(frame);
    check(frame.stereo);
}

double world_unit(const Placement& placement) {
    double longest = 0;
    for (const auto& row : placement.affine.m)
        for (size_t axis = 0; axis < 3; ++axis)
            longest = std::max(longest, std::abs(row[axis]) * placement.dims[axis]);
    return power_of_two_below(longest);
}

shared::FrameInfo make_frame_info(const Frame& in_world, const Placement& placement,
                                  const Stored& stored) {
    const double unit = world_unit(placement);
    const Frame frame = in_units(in_world, unit);
    Eye middle = make_eye(frame.camera, frame.size);
    const dmat4 world = world_from_voxel(placement.affine, unit), voxel = glm::inverse(world);
    fit_depth(middle, world, placement.dims);
    shared::FrameInfo info{};
    std::vector<dmat4> clip_from_voxel;
    for (uint32_t i = 0; i < frame.eyes(); ++i) {
        const Eye eye = frame.eyes() == 1 ? middle : moved(middle, frame, i == 0 ? -1 : 1);
        const dmat4 clip = clip_from_world(eye) * world;
        clip_from_voxel.push_back(clip);
        info.eyes[i].clip_from_voxel = glm::mat4(clip);
        set_rays(info.eyes[i], eye, voxel);
        set_planes(info.eyes[i], clip);
    }
    set_clips(info, frame, world, clip_from_voxel);
    set_surfaces(info, frame, stored);
    info.depth_range = {float(middle.near), float(middle.far), middle.orthographic ? 1.0f : 0.0f,
                        0};
    // Normals follow the inverse transpose: its rows are the columns of the inverse.
    // Their length does not matter; floats should hold products with any gradient.
    dmat3 normal = glm::transpose(dmat3(voxel));
    double most = 0;
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < 3; ++i)
            most = std::max(most, std::abs(normal[axis][i]));
    normal /= power_of_two_below(most);
    const dmat4 rows = glm::transpose(world), normal_rows = dmat4(glm::transpose(normal));
    info.normal_x = glm::vec4(normal_rows[0]);
    info.normal_y = glm::vec4(normal_rows[1]);
    info.normal_z = glm::vec4(normal_rows[2]);
    info.world_x = glm::vec4(rows[0]);
    info.world_y = glm::vec4(rows[1]);
    info.world_z = glm::vec4(rows[2]);
    // The light comes from behind the viewer's left shoulder.
    const dvec3 light = -middle.forward - 0.5 * middle.right + 0.7 * middle.up;
    info.light = glm::vec4(glm::normalize(glm::vec3(light)), 0);
    info.background = {frame.background.r, frame.background.g, frame.background.b,
                       frame.background.a};
    info.size = {frame.size.width, frame.size.height, frame.isovalues.size(),
                 uint32_t(frame.shading)};
    info.counts = {frame.eyes(), frame.clips.size(), 0, 0};
    return info;
}

}  // namespace isorast
