// SPDX-License-Identifier: MIT
// Where the eye is, in world coordinates, and cameras that show a whole volume.
#pragma once
#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace isorast {

struct Volume;

// Positions in voxel indices that a camera is to show.
using VoxelPoints = std::vector<std::array<double, 3>>;

// Position and target must differ, and up must not lie along the line between them. The field of
// view is between 0 and 180 degrees, the height positive. Renderer::render() checks.
struct Camera {
    std::array<double, 3> position{0, 0, 1}, target{0, 0, 0}, up{0, 1, 0};
    double fov_degrees =
        30;  // across the shorter side of the picture, so that a fit holds for any aspect
    bool orthographic = false;
    double height = 1;  // orthographic only: world units across the shorter side of the picture
};

struct OrbitOptions {
    double roll_degrees = 0;
    double zoom = 1;  // 2 shows things twice as large
    double fov_degrees = 30;
    bool orthographic = false;
    VoxelPoints shown;  // what to fit; empty: the whole volume. See Renderer::surface_hull.
};

// A camera that looks at the middle of what is shown and shows all of it, from `azimuth` degrees
// around the up axis and `elevation` degrees above the horizon. Up is +z of the world, and azimuth
// 0 looks from the front: from the patient's anterior (+y) in RAS, else from -y. The fit uses real
// world positions: anisotropic spacing, oblique and sheared axes keep their aspect. Throws Error
// for angles that are not finite, a zoom that is not positive and finite, and a field of view
// outside 0 to 180 degrees.
Camera orbit(const Volume& volume, double azimuth_degrees, double elevation_degrees,
             const OrbitOptions& options = {});

// "+x" "-x" "+y" "-y" "+z" "-z": seen from that side of the world; "A" "P" "L" "R" "S" "I": seen
// from that side of the patient. Nothing for other words. Throws Error for a patient side when the
// space is unknown, and for options as orbit() does.
std::optional<Camera> view_preset(const Volume& volume, std::string_view word,
                                  const OrbitOptions& options = {});

}  // namespace isorast
