// SPDX-License-Identifier: MIT
// How a volume is cut into 3D images.
#include "grid/bricks.h"

#include <fmt/format.h>
#include <isorast/error.h>

#include "shaders/shared.h"

namespace isorast {

namespace {

glm::uvec3 divide_up(glm::uvec3 a, glm::uvec3 b) {
    return (a + b - 1u) / b;
}

uint64_t product(glm::uvec3 v) {
    return uint64_t{v.x} * v.y * v.z;
}

}  // namespace

glm::uvec3 BrickPlan::origin(uint32_t index) const {
    const glm::uvec3 first = where(index) * brick_cells;
    return first - glm::min(first, glm::uvec3(1));
}

glm::uvec3 BrickPlan::extent(uint32_t index) const {
    const glm::uvec3 end = glm::min((where(index) + 1u) * brick_cells + 2u, voxels);
    return end - origin(index);
}

BrickPlan plan_bricks(glm::uvec3 voxels, uint32_t voxel_bytes, uint32_t max_side,
                      uint64_t max_bytes) {
    if (glm::all(glm::lessThanEqual(voxels, glm::uvec3(max_side))) &&
        product(voxels) * voxel_bytes <= max_bytes)
        return {voxels, glm::max(voxels, 2u) - 1u, glm::uvec3(1)};
    const uint32_t apron = 3;  // a voxel below, the far face, a voxel above
    const uint32_t least = shared::BLOCK + apron;
    if (max_side < least)
        throw Error(fmt::format("bricks: expected a side of at least {} voxels, found {}", least,
                                max_side));

    const glm::uvec3 cells = glm::max(voxels, 2u) - 1u;
    const glm::uvec3 longest = glm::uvec3((max_side - apron) / shared::BLOCK * shared::BLOCK);
    glm::uvec3 count = divide_up(cells, longest);
    for (;;) {
        // Bricks of equal size along each axis, in whole blocks.
        const glm::uvec3 block(shared::BLOCK);
        const glm::uvec3 brick = divide_up(divide_up(cells, count), block) * block;
        if (product(brick + apron) * voxel_bytes <= max_bytes || brick == block)
            return {voxels, brick, divide_up(cells, brick)};
        // Cut the longest side once more.
        int axis = 2;
        for (int i = 1; i >= 0; --i)
            if (brick[i] > brick[axis]) axis = i;
        ++count[axis];
    }
}

}  // namespace isorast
