// SPDX-License-Identifier: MIT
// How a volume is cut into 3D images: bricks of whole blocks, with an apron of one voxel.
#pragma once
#include <glm/glm.hpp>

#include <cstdint>

namespace isorast {

struct BrickPlan {
    glm::uvec3 voxels{1};       // of the volume
    glm::uvec3 brick_cells{1};  // whole blocks, unless there is one brick only
    glm::uvec3 bricks{1};

    bool one() const { return bricks == glm::uvec3(1); }
    uint32_t count() const { return bricks.x * bricks.y * bricks.z; }
    glm::uvec3 where(uint32_t index) const {
        return {index % bricks.x, index / bricks.x % bricks.y, index / (bricks.x * bricks.y)};
    }
    // The voxel in texel 0 of a brick, and its texels: its cells' voxels and the apron, inside the
    // volume.
    glm::uvec3 origin(uint32_t index) const;
    glm::uvec3 extent(uint32_t index) const;
};

// The fewest bricks whose sides are at most `max_side` voxels and whose bytes are at most
// `max_bytes`. Throws Error when max_side is less than a block and its apron need (11).
BrickPlan plan_bricks(glm::uvec3 voxels, uint32_t voxel_bytes, uint32_t max_side,
                      uint64_t max_bytes);

}  // namespace isorast
