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
    Camera camera(const Volume& volume) const;
};

}  // namespace isorast::cli
