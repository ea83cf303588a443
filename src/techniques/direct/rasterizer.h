// SPDX-License-Identifier: MIT
// The two ways to turn listed blocks into depth: mesh shaders and the device's rasterizer
// (hardware.cpp), or compute alone (compute.cpp). All else of direct is the same for both.
#pragma once
#include <memory>

#include "gpu/commands.h"
#include "grid/grid.h"
#include "image/target.h"
#include "techniques/direct/culling.h"

namespace isorast {

class DirectRasterizer {
public:
    virtual ~DirectRasterizer() = default;
    // Nothing drawn yet: depth 0, and the background where the rasterizer colours. Ends with a
    // barrier.
    virtual void clear(gpu::Commands& commands, const Frame& frame, const Target& target) = 0;
    // The blocks that culling has listed, of one surface. Ends with a barrier.
    virtual void draw(gpu::Commands& commands, const Frame& frame, uint32_t surface,
                      const Culling& culling, const Target& target) = 0;
};

// `cases`: the table of marching cubes, 256 x uvec2.
std::unique_ptr<DirectRasterizer> make_hardware(const Grid& grid, const gpu::Buffer& cases);
std::unique_ptr<DirectRasterizer> make_compute(const Grid& grid, const gpu::Buffer& cases);

}  // namespace isorast
