// SPDX-License-Identifier: MIT
// Cameras that show a whole volume, or a part of it: world positions are fitted into the square
// frustum across the shorter side of the picture. Everything happens in
// world space, so left-handed voxel axes (negative determinant) are not mirrored.
#include <isorast/camera.h>
#include <isorast/error.h>
#include <isorast/volume.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

namespace isorast {
namespace {

using glm::dvec3;

constexpr double FILL = 0.96;  // share of the frustum to fill: a margin of 4 %

std::array<double, 3> array(const dvec3& v) {
    return {v.x, v.y, v.z};
}

// What to show, in world positions.
std::vector<dvec3> world_points(const Volume& volume, const VoxelPoints& shown) {
    VoxelPoints points = shown;
    if (points.empty())
        for (int c = 0; c < 8; ++c)
            points.push_back({c & 1 ? volume.dims[0] - 1.0 : 0, c & 2 ? volume.dims[1] - 1.0 : 0,
                              c & 4 ? volume.dims[2] - 1.0 : 0});
    std::vector<dvec3> world;
    for (const auto& [i, j, k] : points) {
        const auto p = volume.affine(i, j, k);
        world.emplace_back(p[0], p[1], p[2]);
    }
    return world;
}

// The middle of the points' extents along the camera's axes.
dvec3 middle_of(const std::vector<dvec3>& points, const std::array<dvec3, 3>& axes) {
    dvec3 middle(0);
    for (const dvec3& axis : axes) {
        double low = INFINITY, high = -INFINITY;
        for (const dvec3& point : points) {
            low = std::min(low, glm::dot(point, axis));
            high = std::max(high, glm::dot(point, axis));
        }
        middle += (low + high) / 2 * axis;
    }
    return middle;
}

// Half the largest spacing: keeps the fit finite for volumes that are one voxel thin.
double half_voxel(const Volume& volume) {
    const auto spacing = volume.affine.spacing();
    const double half = *std::max_element(spacing.begin(), spacing.end()) / 2;
    return half > 0 ? half : 0.5;
}

// Look at the middle of what is shown from the direction `eye`; `eye` and `up` are orthonormal.
Camera look_from(const Volume& volume, const dvec3& eye, const dvec3& up_without_roll,
                 const OrbitOptions& options) {
    if (!(options.zoom > 0) || !std::isfinite(options.zoom) ||
        !std::isfinite(options.roll_degrees)) {
        throw Error("camera: zoom must be positive, zoom and roll finite");
    }
    if (!(options.fov_degrees > 0 && options.fov_degrees < 180)) {
        throw Error("camera: the field of view must be between 0 and 180 degrees");
    }
    // Roll the camera clockwise: the picture turns the other way.
    const double roll = glm::radians(options.roll_degrees);
    const dvec3 right_without_roll = glm::cross(up_without_roll, eye);
    const dvec3 up = std::cos(roll) * up_without_roll + std::sin(roll) * right_without_roll;
    const dvec3 right = glm::cross(up, eye);

    // Find the closest distance, and the smallest orthographic height, that show every point.
    const std::vector<dvec3> points = world_points(volume, options.shown);
    const dvec3 middle = middle_of(points, {right, up, eye});
    const double least = half_voxel(volume);
    const double slope = std::tan(glm::radians(options.fov_degrees) / 2);
    double distance = 0, half_height = 0;
    for (const dvec3& point : points) {
        const dvec3 p = point - middle;
        const double side =
            std::max({std::abs(glm::dot(p, right)), std::abs(glm::dot(p, up)), least});
        half_height = std::max(half_height, side / FILL);
        distance = std::max(distance, side / (FILL * slope) + glm::dot(p, eye));
    }

    // Zoom narrows the view and leaves the eye where it is, so that it never enters the object.
    Camera camera;
    camera.position = array(middle + distance * eye);
    camera.target = array(middle);
    camera.up = array(up);
    camera.fov_degrees = 2 * glm::degrees(std::atan(slope / options.zoom));
    camera.orthographic = options.orthographic;
    camera.height = 2 * half_height / options.zoom;
    return camera;
}

}  // namespace

Camera orbit(const Volume& volume, double azimuth_degrees, double elevation_degrees,
             const OrbitOptions& options) {
    if (!std::isfinite(azimuth_degrees) || !std::isfinite(elevation_degrees)) {
        throw Error("camera: azimuth and elevation must be finite");
    }
    // The front is turned counter-clockwise, seen from above.
    const double azimuth = glm::radians(azimuth_degrees),
                 elevation = glm::radians(elevation_degrees);
    const double front = volume.space == Space::ras ? 1 : -1;
    const dvec3 level = front * dvec3(-std::sin(azimuth), std::cos(azimuth), 0);
    const dvec3 z(0, 0, 1);
    // The up vector is the derivative of the eye's direction: defined at the poles as well.
    const dvec3 eye = std::cos(elevation) * level + std::sin(elevation) * z;
    const dvec3 up = std::cos(elevation) * z - std::sin(elevation) * level;
    return look_from(volume, eye, up, options);
}

std::optional<Camera> view_preset(const Volume& volume, std::string_view word,
                                  const OrbitOptions& options) {
    struct Side {
        std::string_view axis, patient;
        dvec3 eye, up;
    };
    static constexpr Side SIDES[] = {
        {"+x", "R", {1, 0, 0}, {0, 0, 1}}, {"-x", "L", {-1, 0, 0}, {0, 0, 1}},
        {"+y", "A", {0, 1, 0}, {0, 0, 1}}, {"-y", "P", {0, -1, 0}, {0, 0, 1}},
        {"+z", "S", {0, 0, 1}, {0, 1, 0}}, {"-z", "I", {0, 0, -1}, {0, 1, 0}},
    };
    for (const Side& side : SIDES) {
        if (word != side.axis && word != side.patient) continue;
        if (word == side.patient && volume.space == Space::unknown) {
            throw Error(
                volume.name + ": view \"" + std::string(word) +
                "\" names a side of a patient, but the file does not say how the patient lies; "
                "use +x -x +y -y +z or -z");
        }
        return look_from(volume, side.eye, side.up, options);
    }
    return std::nullopt;
}

}  // namespace isorast
