// SPDX-License-Identifier: MIT
// A whole isosurface as a mesh in memory: extracted on the GPU from the blocks that it crosses
// (marching cubes, Lorensen and Cline 1987), welded as it is made: each crossed edge of the grid is
// one vertex, whichever cells, blocks and bricks share it.
#pragma once
#include <glm/glm.hpp>

#include "grid/grid.h"

namespace isorast {

// Positions are in voxel space. Vertices and triangles come block by block, x fastest.
struct Surface {
    std::vector<glm::vec3> positions;
    // Only if asked for: xyz: the field's gradient, stored units a voxel; w: the direction of the
    // vertex's edge, x y z for 0 1 2 if the vertex lies at its lower corner, else for 3 4 5.
    std::vector<glm::vec4> gradients;
    std::vector<glm::uvec3> triangles;  // counter-clockwise seen from outside

    struct Block {
        uint32_t block, first_vertex, first_triangle;
    };
    std::vector<Block>
        blocks;  // all that have vertices or triangles, ascending; one more at the end
};

class SurfaceExtractor {
public:
    SurfaceExtractor(const Grid& grid, bool gradients);

    // `isovalue` in stored units. Submits to the device's queue and waits; the result is the same
    // every time. Throws Error where the surface has more vertices than 32 bits can number.
    Surface extract(float isovalue) const;
    uint64_t gpu_bytes() const { return cases_.bytes(); }

private:
    struct Batch;
    std::vector<uint32_t> count(float isovalue) const;
    Batch next_batch(const Surface& surface, size_t first) const;
    void extract_batch(float isovalue, const Batch& batch, Surface& surface) const;

    const Grid& grid_;
    bool gradients_;
    gpu::Pipeline count_, vertices_, triangles_;
    gpu::Buffer cases_;  // marching cubes: 256 x uvec2
};

}  // namespace isorast
