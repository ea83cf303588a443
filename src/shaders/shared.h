// SPDX-License-Identifier: MIT
// Structures and constants that C++ and GLSL share. Only 16-byte members in uniform blocks, so that
// std140 and C++ agree; sizes are asserted below.
#ifndef ISORAST_SHADERS_SHARED_H
#define ISORAST_SHADERS_SHARED_H

#ifdef __cplusplus
#include <glm/glm.hpp>

#include <cstdint>
namespace isorast::shared {
using glm::mat4;
using glm::uvec2;
using glm::uvec4;
using glm::vec4;
using uint = uint32_t;
#define ISORAST_CONSTANT static constexpr
#else
#define ISORAST_CONSTANT const
#endif

// A block is 8^3 cells: the grain of min-max, of the active list, of culling and of extraction. The
// paper extracts 8x8x4 cells (section 3.2), so that a cell's index fits 8 bits.
ISORAST_CONSTANT uint BLOCK = 8;
// A group is 4x4x2 = 32 blocks: one 32-bit mask of active blocks.
ISORAST_CONSTANT uint GROUP_X = 4, GROUP_Y = 4, GROUP_Z = 2, GROUP_BLOCKS = 32;
// Drawn blocks are listed in quartets of 2x2x1: a quarter of the memory of a list of blocks. A draw
// takes 2^19 quartets, 32768 in a row: with four workgroups each, no more than every device can
// launch at once (2^22) and along an axis (65535).
ISORAST_CONSTANT uint QUARTETS = 8, DRAW_QUARTETS = 1 << 19, DRAW_ROW = 1 << 15;
// A draw of a list: indirect arguments, workgroups for quartets along x and y and for the blocks of
// each along z; in a list's first draw, how many quartets the list holds.
struct Draw {
    uint x, y, z;
    uint quartets;
};
// Most workgroups that one list-driven dispatch starts; they loop over longer lists.
ISORAST_CONSTANT uint MAX_LIST_GROUPS = 32768;
ISORAST_CONSTANT uint CULL_GROUPS = 4;  // that a cull pass's workgroup selects blocks of at once
ISORAST_CONSTANT uint MAX_LEVELS = 30;  // of the min-max pyramid: any number of blocks a side
ISORAST_CONSTANT uint MAX_BRICKS = 64;
ISORAST_CONSTANT uint MAX_SURFACES = 32;  // opaque surfaces in one picture
ISORAST_CONSTANT uint MAX_CLIPS = 8;      // clip planes

// Descriptor set 0, the same in every pipeline.
ISORAST_CONSTANT uint BIND_FRAME = 0, BIND_GRID = 1, BIND_BRICKS = 2, BIND_SAMPLER = 3,
                      BIND_MINMAX = 4, BIND_VOXELS = 5;
// Added to the bits of a voxel where shaders fetch voxels from a buffer.
ISORAST_CONSTANT uint VOXELS_IN_BUFFER = 64;

struct GridInfo {
    uvec4 voxels;       // xyz: voxels along each axis; w: a row in VOXELS_IN_BUFFER, in voxels
    uvec4 blocks;       // xyz: blocks along each axis; w: all
    uvec4 groups;       // xyz: groups along each axis; w: all
    uvec4 brick_cells;  // xyz: cells of a brick along each axis, whole blocks; w: a slice there
    uvec4 bricks;       // xyz: bricks along each axis; w: levels of the min-max pyramid
    vec4 range;  // x: the least value that gradients see; voxels that are not finite do no harm so
    uvec4 levels[MAX_LEVELS];  // xyz: nodes along each axis; w: index of the level's first node
};

// What one eye sees. Positions are in voxel space: voxel centres at whole numbers.
struct EyeInfo {
    mat4 clip_from_voxel;  // reversed depth: 1 at the near plane, 0 at the far plane
    // The ray of the point (x, y) in normalized device coordinates: origin + x*origin_x +
    // y*origin_y, and the same for its direction, whose length is one unit of view depth in the
    // world.
    vec4 ray_origin, ray_origin_x, ray_origin_y;
    vec4 ray_direction, ray_direction_x, ray_direction_y;
    vec4 planes[6];         // of the frustum, inside is positive
    vec4 clips[MAX_CLIPS];  // clip planes for (x, y, depth, 1) in normalized device coordinates
};

// One frame of one or two eyes, which look the same way: a point has the same depth for both.
struct FrameInfo {
    EyeInfo eyes[2];
    vec4 depth_range;                   // near, far (view depth, world units); z: 1 if orthographic
    vec4 clips[MAX_CLIPS];              // clip planes in voxel space, kept is positive
    vec4 normal_x, normal_y, normal_z;  // rows: world normal from a gradient in voxel space
    vec4 world_x, world_y, world_z;     // rows: world position from voxel space
    vec4 light;                         // xyz: direction towards the light, world; w unused
    vec4 background;                    // sRGB, alpha
    uvec4 size;                   // width, height of an eye's picture; z: surfaces; w: Shading
    uvec4 counts;                 // x: eyes; y: clip planes
    vec4 surfaces[MAX_SURFACES];  // rgb: sRGB colour; w: isovalue in stored units
};

// What the passes count; see FrameStats.
struct Counters {
    uint blocks_active, blocks_drawn, unused_0, unused_1;
};

#ifdef __cplusplus
static_assert(sizeof(Draw) == 16);
static_assert(sizeof(GridInfo) == 16 * (6 + MAX_LEVELS));
static_assert(sizeof(EyeInfo) == 64 + 16 * (6 + 6 + MAX_CLIPS));
static_assert(sizeof(FrameInfo) ==
              2 * sizeof(EyeInfo) + 16 * (1 + MAX_CLIPS + 3 + 3 + 1 + 1 + 1 + 1 + MAX_SURFACES));
}  // namespace isorast::shared
#endif
#endif
