// SPDX-License-Identifier: MIT
// The two ways to turn listed blocks into depth: task and mesh shaders and the graphics pipeline
// (hardware.cpp), or compute alone (compute.cpp). All else of direct is the same for both.
#pragma once
#include <memory>

#include "techniques/direct/culling.h"
#include "techniques/technique.h"

namespace isorast {

class BlockRasterizer {
public:
    virtual ~BlockRasterizer() = default;
    // Depth 0, and the background where the rasterizer colours; done at the next barrier.
    virtual void clear(gpu::Commands& commands, const Frame& frame, const Target& target) const = 0;
    // The blocks of one surface that `culling` has listed. Ends with a barrier.
    virtual void extract(gpu::Commands& commands, const Culling& culling, uint32_t surface,
                         const Frame& frame, const Target& target) = 0;
    virtual Workgroups workgroups() const = 0;
    virtual uint64_t gpu_bytes() const = 0;
};

// The first throws Error where the device cannot.
std::unique_ptr<BlockRasterizer> make_hardware_rasterizer(const Grid& grid);
std::unique_ptr<BlockRasterizer> make_compute_rasterizer(const Grid& grid);

// TriangleTable of both: of each marching-cubes case's five possible triangles, where the corners'
// vertices are (block_lists.glsl, corner_edge); in the first one, bits 29..31, how many there are.
gpu::Buffer upload_triangle_table(const gpu::Device& device);

}  // namespace isorast
