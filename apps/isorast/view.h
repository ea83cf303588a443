// SPDX-License-Identifier: MIT
// The options that say from where to look, with which eyes, and what is cut away.
#pragma once
#include "options.h"

namespace isorast::cli {

// "x>12.5": what is cut away is where this does not hold.
struct ClipArgument {
    char axis = 'x';  // x y z: world coordinates; i j k: voxel indices
    bool keeps_greater = true;
    double value = 0;
    bool percent = false;  // of the volume's extent along the axis
};

struct ViewArguments {
    double azimuth = 30, elevation = 20;
    OrbitOptions orbit;
    std::string preset;
    std::optional<std::array<double, 3>> position, target, up;
    Stereo stereo;
    std::vector<ClipArgument> clips;

    void add_to(CLI::App& app);
    // Shows these points, or the whole volume when there are none.
    Camera camera(const Volume& volume, const VoxelPoints& shown) const;
    std::vector<ClipPlane> clip_planes(const Volume& volume) const;

private:
    void add_camera_to(CLI::App& app);
    void add_clips_to(CLI::App& app);
    void add_stereo_to(CLI::App& app);
};

}  // namespace isorast::cli
