// SPDX-License-Identifier: MIT
// Shade: the one pass that turns any technique's depth into the picture.
#pragma once
#include <isorast/renderer.h>

#include <array>

#include "gpu/commands.h"
#include "grid/grid.h"
#include "image/target.h"

namespace isorast {

class Shade {
public:
    // `exact`: never through the texture unit, whose filter has a grid of 1/256 voxels.
    Shade(const Grid& grid, bool exact);
    // Writes target.color (unless the technique did: Shading::forward) and, if wanted,
    // target.distances.
    void record(gpu::Commands& commands, const Frame& frame, const Target& target);

private:
    const gpu::Pipeline& pipeline(bool color, bool distance, bool mark);

    const Grid& grid_;
    bool cleared_;  // by a command: on a CPU, several times faster than writing by a shader
    bool filtered_;
    std::array<gpu::Pipeline, 8> pipelines_;  // made when first needed
    gpu::Buffer no_blocks_;                   // stands in where nothing is marked
};

}  // namespace isorast
