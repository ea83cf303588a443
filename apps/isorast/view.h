// SPDX-License-Identifier: MIT
// The options that say from where to look.
#pragma once
#include "options.h"

namespace isorast::cli {

struct ViewArguments {
    double azimuth = 30, elevation = 20;
    OrbitOptions orbit;
    std::string preset;
    std::optional<std::array<double, 3>> position, target, up;

    void add_to(CLI::App& app);
    // Shows these points, or the whole volume when there are none.
    Camera camera(const Volume& volume, const VoxelPoints& shown) const;
};

}  // namespace isorast::cli
