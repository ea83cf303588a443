#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: one active group at a time. Thread: one block. Out: the list of blocks to draw, in
// chunks, and the indirect arguments to draw it. Culling is in two passes (Kreskowski 2022,
// section 3.5 and figure 2): blocks that the last frame saw are drawn first; then those of all
// others that they do not hide, by a depth pyramid here, or as raster proxies have found before.
#include "shaders/scene.glsl"
#include "techniques/direct/list.glsl"
#include "techniques/direct/frustum.glsl"
#include "techniques/direct/pyramid.glsl"

layout(local_size_x = 32) in;

const uint ALL = 0, SEEN = 1, UNSEEN = 2, TESTED = 3;
layout(constant_id = 1) const uint SELECT = ALL;

struct DrawArguments {
    uint blocks, workgroups, one;  // as VkDispatchIndirectCommand
};
layout(set = 1, binding = 1, std430) buffer Draws { DrawArguments draws[]; };
layout(set = 1, binding = 2, std430) writeonly buffer DrawnBlocks { uint16_t drawn_blocks[]; };
layout(set = 1, binding = 3, std430) buffer CounterBlock { Counters counters; };
layout(set = 1, binding = 4, std430) readonly buffer SeenBlocks { uint seen_blocks[]; };
// What an occlusion test has left: the depth pyramid (UNSEEN), or a bit a block (TESTED).
layout(set = 1, binding = 5, std430) readonly buffer Pyramid { float pyramid[]; };
layout(set = 1, binding = 5, std430) readonly buffer TestedBlocks { uint tested_blocks[]; };

shared uint drawn_mask;
shared uint first_entry;

// True if depth already drawn is nearer than all of the block, at every pixel that the block can
// touch.
bool is_hidden(uint eye, vec3 low, vec3 high) {
    Extent extent;
    if (!project(eye, low, high, extent)) return false;
    const vec2 last = vec2(frame.size.xy) - 1.0;
    const uvec2 low_pixel = uvec2(clamp(floor(extent.least), vec2(0.0), last));
    const uvec2 high_pixel = uvec2(clamp(floor(extent.greatest), vec2(0.0), last));
    // The finest level at which the block covers at most 4x4 squares.
    uint level = 1;
    while (level < PYRAMID_LEVELS &&
           any(greaterThan((high_pixel >> level) - (low_pixel >> level), uvec2(3)))) ++level;
    const uvec2 first = low_pixel >> level, end = high_pixel >> level;
    if (any(greaterThan(end - first, uvec2(15)))) return false;  // larger than a thousand pixels
    const uint offset = pyramid_offset(eye, level), width = pyramid_size(level).x;
    for (uint y = first.y; y <= end.y; ++y)
        for (uint x = first.x; x <= end.x; ++x)
            if (pyramid[offset + x + width * y] <= extent.nearest) return false;
    return true;
}

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

void main() {
    const uint place = gl_LocalInvocationIndex;
    for (uint i = gl_WorkGroupID.x; i < group_count; i += gl_NumWorkGroups.x) {
        const uint group = active_groups[i].x;
        if (place == 0) drawn_mask = 0;
        barrier();
        const bool is_active = (active_groups[i].y >> place & 1) != 0;
        const uint marks = SELECT == TESTED ? tested_blocks[group] : seen_blocks[group];
        const bool seen = (marks >> place & 1) != 0;
        const uvec3 block = group_origin(group) + block_in_group(place);
        const bool drawn = is_active && is_selected(block, seen);
        if (drawn) atomicOr(drawn_mask, 1u << place);
        barrier();
        const uint chunk = group / CHUNK_GROUPS;
        if (place == 0 && drawn_mask != 0) {
            first_entry = atomicAdd(draws[chunk].blocks, bitCount(drawn_mask));
            atomicAdd(counters.blocks_drawn, bitCount(drawn_mask));
        }
        barrier();
        if (drawn) {
            const uint rank = bitCount(drawn_mask & ((1u << place) - 1));
            drawn_blocks[chunk * CHUNK_BLOCKS + first_entry + rank] =
                uint16_t(group % CHUNK_GROUPS * GROUP_BLOCKS + place);
        }
        barrier();
    }
}
