#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Workgroup: four active groups at a time. Thread: one block. Out: the list of blocks to draw
// and the indirect arguments to draw it. Culling is in two passes (Kreskowski 2022, section 3.5 and
// figure 2): blocks that the last frame saw are drawn first; then those of all others that they do
// not hide: as raster proxies have found before, or, HIZ, by a depth pyramid, and once more, finer,
// for what that leaves. In between, SURFACES, those that surfaces around do not hide.
// variant cull_hiz: -DHIZ
// variant cull_surfaces: -DHIZ -DSURFACES
#include "shaders/scene.glsl"
#include "techniques/direct/limits.glsl"
#include "techniques/direct/list.glsl"
#include "techniques/direct/active_groups.glsl"
#include "shaders/frustum.glsl"

layout(local_size_x = CULL_GROUPS * GROUP_BLOCKS) in;

// Workgroups that share a large block; 0: large blocks have no list of their own.
layout(constant_id = 1) const uint LARGE_PARTS = 0;
layout(constant_id = 2) const uint EYES = 1;
const uint ALL = 0, SEEN = 1, TESTED = 2;
#ifdef HIZ
const uint SELECT = 3;
#else
layout(constant_id = 3) const uint SELECT = ALL;
#endif

layout(set = 1, binding = 1, std430) buffer Draws { Draw draws[]; };
// Quartets of small blocks from the start on, of large ones from the end backwards.
layout(set = 1, binding = 2, std430) writeonly buffer DrawnBlocks { uint drawn_quartets[]; };
layout(set = 1, binding = 3, std430) buffer CounterBlock { Counters counters; };
layout(set = 1, binding = 4, std430) readonly buffer SeenBlocks { uint seen_blocks[]; };
#ifdef HIZ
layout(set = 1, binding = 5, std430) readonly buffer Pyramid { float pyramid[]; };
#ifdef SURFACES
layout(set = 1, binding = 6, std430) writeonly buffer DrawnBefore { uint drawn_before[]; };
#endif
#else
layout(set = 1, binding = 5, std430) readonly buffer TestedBlocks { uint tested_blocks[]; };
#endif
layout(push_constant) uniform Push {
    uint first_draw;  // of the list of small blocks; that of large ones follows
    uint draws_of_list;
};

const uint LONG = 8192;  // quartets

shared uint drawn_masks[CULL_GROUPS], large_masks[CULL_GROUPS];
shared uint quartets[2], first_entry[2];  // small, large

void corners_of(uvec3 block, out vec3 low, out vec3 high) {
    low = vec3(block * BLOCK);
    high = min(low + float(BLOCK), vec3(grid.voxels.xyz) - 1.0);
}

#ifdef HIZ
#include "shaders/hidden.glsl"
#include "techniques/direct/in_sight.glsl"

shared uint candidates[CULL_GROUPS * GROUP_BLOCKS];  // group << 5 | place
shared uint candidate_total;
#endif

// True if an eye may see the block. `seen`: in the last frame, by rays, or by raster proxies.
// `look`: only if a closer look finds it in sight.
bool is_selected(uvec3 block, bool seen, out bool large, out bool look) {
    large = look = false;
    if (SELECT != ALL && seen != (SELECT == SEEN || SELECT == TESTED)) return false;
    vec3 low, high;
    corners_of(block, low, high);
    bool selected = false;
    for (uint eye = 0; eye < EYES; ++eye) {
        Extent extent;
        const bool whole = project(eye, low, high, extent);
        // In any eye, also one that does not see it: the block is drawn for both.
        large = large || !whole ||
                any(greaterThan(extent.greatest - extent.least, vec2(SMALL_SIDE))) ||
                any(greaterThan(abs(extent.least), vec2(GUARD)));
        if (SELECT != ALL && SELECT != TESTED && !in_frustum(eye, low, high)) continue;
#ifdef HIZ
        if (whole && is_hidden(eye, extent)) continue;
#endif
        selected = true;
    }
#ifdef HIZ
    look = selected && !large;
#endif
    return selected;
}

// Puts an entry into a list, and into the arguments of its draw.
void list(uint size, uint i, uint entry) {
    drawn_quartets[size == 0 ? i : drawn_quartets.length() - 1 - i] = entry;
    const uint draw = first_draw + size * draws_of_list + i / DRAW_QUARTETS;
    const uint place = i % DRAW_QUARTETS;
    if (place % DRAW_ROW == 0) atomicMax(draws[draw].y, place / DRAW_ROW + 1);
    // A workgroup for each block of a quartet, so that small volumes fill the device; in long lists
    // one for all, as half of those would find nothing to do.
    const uint parts = size == 0 ? 1 : LARGE_PARTS;
    if (place == 0) atomicAdd(draws[draw].z, 4 * parts);
    if (place == LONG && LARGE_PARTS != 0) atomicAdd(draws[draw].z, -3 * parts);
}

// Widens draws of a list that has become `quartets` long: the first row of each is full, or ends
// with the list.
void widen(uint size, uint before, uint count) {
    for (uint i = before / DRAW_QUARTETS; i * DRAW_QUARTETS < before + count; ++i)
        atomicMax(draws[first_draw + size * draws_of_list + i].x,
                  min(before + count - i * DRAW_QUARTETS, DRAW_ROW));
}

void main() {
    const uint thread = gl_LocalInvocationIndex;
    const uint lane = thread / GROUP_BLOCKS, place = thread % GROUP_BLOCKS;
    for (uint first = CULL_GROUPS * gl_WorkGroupID.x; first < group_count;
         first += CULL_GROUPS * gl_NumWorkGroups.x) {
        if (thread < CULL_GROUPS) drawn_masks[thread] = large_masks[thread] = 0;
        if (thread < 2) quartets[thread] = 0;
#ifdef HIZ
        if (thread == 0) candidate_total = 0;
#endif
        barrier();
        if (first + lane < group_count) {
            const uvec2 group = active_groups[first + lane];
#ifdef HIZ
            const uint marks = seen_blocks[group.x];
#else
            const uint marks = SELECT == TESTED ? tested_blocks[group.x] & ~seen_blocks[group.x]
                                                : seen_blocks[group.x];
#endif
            bool large, look;
            if ((group.y >> place & 1) != 0 &&
                is_selected(group_origin(group.x) + block_in_group(place),
                            (marks >> place & 1) != 0, large, look)) {
#ifdef HIZ
                if (look) candidates[atomicAdd(candidate_total, 1)] = lane << 5 | place;
#endif
                if (!look) atomicOr(drawn_masks[lane], 1u << place);
                if (LARGE_PARTS != 0 && large) atomicOr(large_masks[lane], 1u << place);
            }
        }
        barrier();
#ifdef HIZ
        // A team of threads for each candidate.
        for (uint i = thread / TEAM; i < candidate_total; i += CULL_GROUPS * GROUP_BLOCKS / TEAM) {
            const uint of = candidates[i] >> 5, at = candidates[i] & 31u;
            vec3 low, high;
            corners_of(group_origin(active_groups[first + of].x) + block_in_group(at), low, high);
            for (uint eye = 0; eye < EYES; ++eye)
                if (in_frustum(eye, low, high) && is_in_sight(eye, low, high, thread % TEAM))
                    atomicOr(drawn_masks[of], 1u << at);
        }
        barrier();
#endif
#ifdef SURFACES
        if (thread < CULL_GROUPS && first + thread < group_count) {
            const uint group = active_groups[first + thread].x;
            drawn_before[group] = seen_blocks[group] | drawn_masks[thread];
        }
#endif
        // The first threads: a quartet each. It is large if one of its blocks is.
        uint mask = 0, size = 0, number = 0;
        const uint of_group = thread / QUARTETS, quartet = thread % QUARTETS;
        if (thread < CULL_GROUPS * QUARTETS) {
            mask = quartet_mask(drawn_masks[of_group], quartet);
            size = quartet_mask(large_masks[of_group], quartet) != 0 ? 1 : 0;
            if (mask != 0) number = atomicAdd(quartets[size], 1);
        }
        barrier();
        if (thread < 2 && quartets[thread] != 0) {
            const uint count = quartets[thread];
            first_entry[thread] =
                atomicAdd(draws[first_draw + thread * draws_of_list].quartets, count);
            widen(thread, first_entry[thread], count);
        }
        if (thread == 0) {
            uint blocks = 0;
            for (uint i = 0; i < CULL_GROUPS; ++i) blocks += bitCount(drawn_masks[i]);
            if (blocks != 0) atomicAdd(counters.blocks_drawn, blocks);
        }
        barrier();
        if (mask != 0)
            list(size, first_entry[size] + number,
                 (QUARTETS * active_groups[first + of_group].x + quartet) << 4 | mask);
        barrier();
    }
}
