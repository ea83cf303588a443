#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: one active group at a time. Thread: one block. Out: the list of blocks to draw
// and the indirect arguments to draw it. Culling is in two passes (Kreskowski 2022, section 3.5 and
// figure 2): blocks that the last frame saw are drawn first; then those of all others that they do
// not hide, by a depth pyramid here, or as raster proxies have found before.
#include "shaders/scene.glsl"
#include "techniques/direct/list.glsl"
#include "techniques/direct/active_groups.glsl"
#include "shaders/frustum.glsl"

layout(local_size_x = 32) in;

const uint ALL = 0, SEEN = 1, UNSEEN = 2, TESTED = 3;
layout(constant_id = 1) const uint SELECT = ALL;

// Indirect arguments: workgroups for quartets along x and y, and for the blocks of each along z.
struct DrawArguments {
    uint x, y, z;
};
layout(set = 1, binding = 1, std430) buffer Draws { DrawArguments draws[]; };
layout(set = 1, binding = 2, std430) buffer DrawnBlocks {
    uint quartet_count;
    uint drawn_quartets[];
};
layout(set = 1, binding = 3, std430) buffer CounterBlock { Counters counters; };
layout(set = 1, binding = 4, std430) readonly buffer SeenBlocks { uint seen_blocks[]; };
// What an occlusion test has left: the depth pyramid (UNSEEN), or a bit a block (TESTED).
layout(set = 1, binding = 5, std430) readonly buffer Pyramid { float pyramid[]; };
layout(set = 1, binding = 5, std430) readonly buffer TestedBlocks { uint tested_blocks[]; };

shared uint drawn_mask, quartets;  // of a group: its drawn blocks, and quartets that hold any
shared uint first_entry;

#include "shaders/hidden.glsl"

// `seen`: in the last frame, or by the raster proxies.
bool is_selected(uvec3 block, bool seen) {
    if (SELECT == ALL) return true;
    if (SELECT == TESTED) return seen;
    if (seen != (SELECT == SEEN)) return false;
    const vec3 low = vec3(block * BLOCK);
    const vec3 high = min(low + float(BLOCK), vec3(grid.voxels.xyz) - 1.0);
    for (uint eye = 0; eye < frame.counts.x; ++eye)
        if (in_frustum(eye, low, high) && (SELECT == SEEN || !is_hidden(eye, low, high)))
            return true;
    return false;
}

// Puts an entry into the list, and into the arguments of its draw.
void list(uint i, uint entry, bool is_last) {
    drawn_quartets[i] = entry;
    const uint draw = i / DRAW_QUARTETS, place = i % DRAW_QUARTETS;
    if (place % DRAW_ROW == 0) atomicAdd(draws[draw].y, 1);
    if (place == DRAW_ROW - 1 || (is_last && place < DRAW_ROW))
        atomicMax(draws[draw].x, place + 1);
}

void main() {
    const uint place = gl_LocalInvocationIndex;
    for (uint i = gl_WorkGroupID.x; i < group_count; i += gl_NumWorkGroups.x) {
        const uint group = active_groups[i].x;
        if (place == 0) drawn_mask = quartets = 0;
        barrier();
        const bool is_active = (active_groups[i].y >> place & 1) != 0;
        const uint marks = SELECT == TESTED ? tested_blocks[group] : seen_blocks[group];
        const bool seen = (marks >> place & 1) != 0;
        const uvec3 block = group_origin(group) + block_in_group(place);
        if (is_active && is_selected(block, seen)) atomicOr(drawn_mask, 1u << place);
        barrier();
        const uint mask = place < QUARTETS ? quartet_mask(drawn_mask, place) : 0;
        if (mask != 0) atomicOr(quartets, 1u << place);
        barrier();
        if (place == 0 && quartets != 0) {
            first_entry = atomicAdd(quartet_count, bitCount(quartets));
            atomicAdd(counters.blocks_drawn, bitCount(drawn_mask));
        }
        barrier();
        if (mask != 0)
            list(first_entry + bitCount(quartets & ((1u << place) - 1)),
                 (QUARTETS * group + place) << 4 | mask, quartets >> place == 1);
        barrier();
    }
}
