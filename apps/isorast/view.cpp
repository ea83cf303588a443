// SPDX-License-Identifier: MIT
// The options that say from where to look; see view.h.
#include "view.h"

#include <cmath>
#include <glm/geometric.hpp>
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

}  // namespace

void ViewArguments::add_to(CLI::App& app) {
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

Camera ViewArguments::camera(const Volume& volume, const VoxelPoints& shown) const {
    OrbitOptions options = orbit;
    options.shown = shown;
    if (!preset.empty()) return *view_preset(volume, preset, options);
    const Camera fitted = isorast::orbit(volume, azimuth, elevation, options);
    return position ? placed(*this, fitted) : fitted;
}

}  // namespace isorast::cli
