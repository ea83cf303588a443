// SPDX-License-Identifier: MIT
// The options of view.h.
#include "view.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

namespace isorast::cli {
namespace {

constexpr const char* GROUP = "Camera";

// The camera that the user has placed: up is +z, or +y for one that looks along z.
Camera placed(const ViewArguments& view, Camera camera) {
    const auto vec = [](const std::array<double, 3>& v) { return glm::dvec3(v[0], v[1], v[2]); };
    camera.position = *view.position;
    camera.target = view.target.value_or(camera.target);
    const glm::dvec3 way = vec(camera.target) - vec(camera.position);
    const double distance = glm::length(way);
    if (distance == 0) throw Error("--camera-position: the same point as --camera-target");
    const auto is_along = [&](const std::array<double, 3>& up) {
        return glm::length(glm::cross(way, vec(up))) <= 1e-6 * distance * glm::length(vec(up));
    };
    camera.up = {0, 0, 1};
    if (is_along(camera.up)) camera.up = {0, 1, 0};
    if (view.up) camera.up = *view.up;
    if (is_along(camera.up)) throw Error("--camera-up: must not lie along the viewing direction");
    // Orthographic: as large at the target as in perspective.
    camera.height = 2 * distance * std::tan(glm::radians(camera.fov_degrees) / 2);
    return camera;
}

ClipArgument parse_clip(const std::string& text) {
    const auto fail = [&] {
        return CLI::ValidationError(
            "--clip",
            fmt::format("expected an axis (x y z in the world, i j k in voxels), < or >, "
                        "and a number or a percentage, as in x>12.5 or k<40%; found \"{}\"",
                        text));
    };
    ClipArgument clip;
    if (text.size() < 3 || !std::strchr("xyzijk", text[0]) || !std::strchr("<>", text[1]))
        throw fail();
    clip.axis = text[0];
    clip.keeps_greater = text[1] == '>';
    clip.percent = text.back() == '%';
    const char *first = text.data() + 2, *end = text.data() + text.size() - (clip.percent ? 1 : 0);
    const auto [stop, error] = std::from_chars(first, end, clip.value);
    if (error != std::errc() || stop != end || !std::isfinite(clip.value)) throw fail();
    return clip;
}

// The plane of a voxel index, or of a world coordinate.
ClipPlane plane_of(const ClipArgument& clip, const Volume& volume) {
    const auto& m = volume.affine.m;
    glm::dmat4 world(1);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            world[column][row] = m[row][column];
    const bool voxels = clip.axis >= 'i' && clip.axis <= 'k';
    const int axis = voxels ? clip.axis - 'i' : clip.axis - 'x';
    // A row (normal, constant): the coordinate that is compared, as a function of world positions.
    const glm::dvec4 unit(axis == 0, axis == 1, axis == 2, 0);
    const glm::dvec4 row = voxels ? unit * glm::inverse(world) : unit;
    double value = clip.value;
    if (clip.percent) {
        double low = INFINITY, high = -INFINITY;
        for (int c = 0; c < 8; ++c) {
            const auto end = [&](int i) { return c >> i & 1 ? volume.dims[i] - 1.0 : 0.0; };
            const double there = glm::dot(row, world * glm::dvec4(end(0), end(1), end(2), 1));
            low = std::min(low, there);
            high = std::max(high, there);
        }
        value = low + (high - low) * clip.value / 100;
    }
    const double sign = clip.keeps_greater ? 1 : -1;
    return {{sign * row.x, sign * row.y, sign * row.z}, sign * (value - row.w)};
}

std::string why_no_length(const std::string& text) {
    char* end = nullptr;
    const double length = std::strtod(text.c_str(), &end);
    if (*end == '\0' && length > 0 && std::isfinite(length)) return "";
    return "expected a length greater than 0, found " + text;
}

}  // namespace

void ViewArguments::add_to(CLI::App& app) {
    add_camera_to(app);
    add_clips_to(app);
    add_stereo_to(app);
}

void ViewArguments::add_clips_to(CLI::App& app) {
    app.add_option_function<std::vector<std::string>>(
           "--clip",
           [this](const std::vector<std::string>& words) {
               for (const std::string& word : words)
                   clips.push_back(parse_clip(word));
           },
           "Keep only what lies there, e.g. 'x>12.5' (world), 'k<40' (voxels), 'y>50%'; repeatable")
        ->type_name("WHERE")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->group("Surface");
}

void ViewArguments::add_stereo_to(CLI::App& app) {
    app.add_option_function<std::string>(
           "--stereo",
           [this](const std::string& word) { stereo.mode = parse_stereo(word).value(); },
           "Two eyes: off (default), side-by-side (twice --size), anaglyph (red-cyan), or layers "
           "(a "
           "file for each eye)")
        ->type_name("MODE")
        ->check(CLI::IsMember({"off", "side-by-side", "anaglyph", "layers"}).description(""))
        ->group(GROUP);
    const auto add_length = [&](const char* name, const char* help, std::optional<double>& length) {
        app.add_option_function<double>(
               name, [&length](double value) { length = value; }, help)
            ->type_name("LENGTH")
            ->check(CLI::Validator(why_no_length, ""))
            ->group(GROUP);
    };
    add_length("--eye-separation",
               "Between the eyes, world units; default: a 30th of the convergence distance",
               stereo.separation);
    add_length("--convergence",
               "Where the eyes see the same, world units from them; default: the target",
               stereo.convergence);
}

void ViewArguments::add_camera_to(CLI::App& app) {
    CLI::Option* turns[] = {
        app.add_option("--azimuth", azimuth, "Degrees around the up axis, 0 from the front"),
        app.add_option("--elevation", elevation, "Degrees above the horizon"),
        app.add_option("--roll", orbit.roll_degrees, "Degrees to turn the camera clockwise")};
    for (CLI::Option* turn : turns)
        turn->type_name("DEGREES")->capture_default_str()->group(GROUP);
    CLI::Option* side = app.add_option("--view", preset,
                                       "Seen from +x -x +y -y +z -z, or the patient's A P L R S I")
                            ->type_name("SIDE")
                            ->check(CLI::IsMember({"+x", "-x", "+y", "-y", "+z", "-z", "A", "P",
                                                   "L", "R", "S", "I"})
                                        .description(""))
                            ->excludes(turns[0])
                            ->excludes(turns[1])
                            ->group(GROUP);
    app.add_option("--zoom", orbit.zoom, "2 shows things twice as large")
        ->type_name("FACTOR")
        ->check(CLI::Range(1e-6, 1e6).description(""))
        ->group(GROUP);
    app.add_option("--fov", orbit.fov_degrees, "Field of view across the shorter side")
        ->type_name("DEGREES")
        ->check(CLI::Range(0.01, 179.0).description(""))
        ->capture_default_str()
        ->group(GROUP);
    app.add_flag("--orthographic", orbit.orthographic, "No perspective")->group(GROUP);

    const auto add_point = [&](const std::string& name, const std::string& help, auto& point) {
        return app
            .add_option_function<std::string>(
                name,
                [name, &point](const std::string& text) {
                    const auto n = parse_numbers(name, text, 3);
                    point = {n[0], n[1], n[2]};
                },
                help)
            ->type_name("X,Y,Z")
            ->group(GROUP);
    };
    CLI::Option* from =
        add_point("--camera-position", "Where the eye is, world coordinates", position);
    add_point("--camera-target", "What it looks at; default: the middle", target)->needs(from);
    add_point("--camera-up", "What is up; default: 0,0,1", up)->needs(from);
    for (CLI::Option* other : turns)
        from->excludes(other);
    from->excludes(side);
}

std::vector<ClipPlane> ViewArguments::clip_planes(const Volume& volume) const {
    std::vector<ClipPlane> planes;
    for (const ClipArgument& clip : clips)
        planes.push_back(plane_of(clip, volume));
    return planes;
}

Camera ViewArguments::camera(const Volume& volume, const VoxelPoints& shown) const {
    OrbitOptions options = orbit;
    options.shown = shown;
    if (!preset.empty()) return *view_preset(volume, preset, options);
    const Camera fitted = isorast::orbit(volume, azimuth, elevation, options);
    return position ? placed(*this, fitted) : fitted;
}

}  // namespace isorast::cli
