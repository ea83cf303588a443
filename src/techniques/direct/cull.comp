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

// As Workgroups in workgroups.h.
layout(constant_id = 1) const uint FOR_LARGE = 0;
layout(constant_id = 5) const uint SPREAD = DRAW_QUARTETS;
layout(constant_id = 6) const uint MOST = 0;
layout(constant_id = 2) const uint EYES = 1;
const uint ALL = 0, SEEN = 1, TESTED = 2;
#ifdef HIZ
const uint SELECT = 3;
#else
layout(constant_id = 3) const uint SELECT = ALL;
#endif
// Otherwise, where the blocks lie has been asked before, or does not matter.
const bool IN_FRUSTUM = SELECT != ALL && SELECT != TESTED;

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

shared uint drawn_masks[CULL_GROUPS], large_masks[CULL_GROUPS];
shared uint quartets[2], first_entry[2];  // small, large

// So many groups, if not 0, a workgroup looks at as wholes first, and leaves most of them out. That
// is one more step to wait for, which pays on CPUs, and on GPUs where groups are very many.
layout(constant_id = 4) const uint SIFTED = 0;
const bool SIFTS = SIFTED != 0;
shared uvec2 sifted[SIFTED != 0 ? SIFTED : 1];
shared uint sifted_total;

// Of so many blocks from the first one on.
void corners_of(uvec3 first, uvec3 blocks, out vec3 low, out vec3 high) {
    low = vec3(first * BLOCK);
    high = min(low + vec3(blocks * BLOCK), vec3(grid.voxels.xyz) - 1.0);
}

#ifdef HIZ
#include "shaders/hidden.glsl"
#include "techniques/direct/in_sight.glsl"

shared uint candidates[CULL_GROUPS * GROUP_BLOCKS];  // group << 5 | place
shared uint candidate_total;
#endif

#ifdef SURFACES
// What comes into sight lies beside what was; the rest is left to the last list. Beside the
// volume's sides other groups are asked, which does no harm.
bool is_near_seen(uint group) {
    const uint last = grid.groups.w - 1;
    const uvec3 steps = uvec3(1, grid.groups.x, grid.groups.x * grid.groups.y);
    uint seen = seen_blocks[group];
    for (int axis = 0; axis < 3; ++axis)
        seen |= seen_blocks[max(group, steps[axis]) - steps[axis]] |
                seen_blocks[min(group + steps[axis], last)];
    return seen != 0;
}
#endif

// Those of a group's active blocks that this list may hold.
uint in_question(uvec2 group) {
#ifdef SURFACES
    if (!is_near_seen(group.x)) return 0;
#endif
#ifdef HIZ
    return group.y & ~seen_blocks[group.x];
#else
    if (SELECT == ALL) return group.y;
    if (SELECT == SEEN) return group.y & seen_blocks[group.x];
    return group.y & tested_blocks[group.x] & ~seen_blocks[group.x];
#endif
}

// True if an eye may see something of the group.
bool is_group_in_sight(uint group) {
    vec3 low, high;
    corners_of(group_origin(group), uvec3(GROUP_X, GROUP_Y, GROUP_Z), low, high);
    for (uint eye = 0; eye < EYES; ++eye) {
        if (!in_frustum(eye, low, high)) continue;
#ifdef HIZ
        Extent extent;
        if (project(eye, low, high, extent) && is_hidden(eye, extent, 4)) continue;
#endif
        return true;
    }
    return false;
}

void sift(uvec2 group) {
    if (in_question(group) != 0 && (!IN_FRUSTUM || is_group_in_sight(group.x)))
        sifted[atomicAdd(sifted_total, 1)] = group;
#ifdef SURFACES
    else
        drawn_before[group.x] = seen_blocks[group.x];
#endif
}

// True if an eye may see the block. `look`: only if a closer look finds it in sight.
bool is_selected(uvec3 block, out bool large, out bool look) {
    large = look = false;
    vec3 low, high;
    corners_of(block, uvec3(1), low, high);
    bool selected = false;
    for (uint eye = 0; eye < EYES; ++eye) {
        Extent extent;
        const bool whole = project(eye, low, high, extent);
        // In any eye, also one that does not see it: the block is drawn for both.
        large = large || !whole ||
                any(greaterThan(extent.greatest - extent.least, vec2(SMALL_SIDE))) ||
                any(greaterThan(abs(extent.least), vec2(GUARD)));
        if (IN_FRUSTUM && !in_frustum(eye, low, high)) continue;
#ifdef HIZ
        if (whole && is_hidden(eye, extent, 16)) continue;
#endif
        selected = true;
    }
#ifdef HIZ
    look = selected && !large;
#endif
    return selected;
}

// Which of its list's draws an entry belongs to, and the first entry of a draw.
uint draw_of(uint i) { return i < SPREAD ? 0 : 1 + (i - SPREAD) / DRAW_QUARTETS; }
uint first_of(uint draw) { return draw == 0 ? 0 : SPREAD + (draw - 1) * DRAW_QUARTETS; }

// Puts an entry into a list, and into the arguments of its draw.
void list(uint size, uint i, uint entry) {
    drawn_quartets[size == 0 ? i : drawn_quartets.length() - 1 - i] = entry;
    const uint nth = draw_of(i), place = i - first_of(nth);
    const uint draw = first_draw + size * draws_of_list + nth;
    if (place == 0 || (MOST == 0 && place % DRAW_ROW == 0))
        atomicMax(draws[draw].y, place / DRAW_ROW + 1);
    const uint of_quartet = FOR_LARGE == 0 || (MOST == 0 && nth == 0) ? 4 : 1;
    if (place == 0) draws[draw].z = of_quartet * (size == 0 ? 1 : FOR_LARGE);
}

// Widens the draws of a list by its entries `before` to `end`: the first row of each is full, or
// ends with the list.
void widen(uint size, uint before, uint end) {
    for (uint nth = draw_of(before); nth <= draw_of(end - 1); ++nth)
        atomicMax(draws[first_draw + size * draws_of_list + nth].x,
                  min(min(end, first_of(nth + 1)) - first_of(nth), MOST == 0 ? DRAW_ROW : MOST));
}

uvec2 group_at(uint i) { return SIFTS ? sifted[i] : active_groups[i]; }

// Lists what is selected of four groups from `first` on, or as many as there are up to `end`.
void select_from(uint first, uint end) {
    const uint thread = gl_LocalInvocationIndex;
    const uint lane = thread / GROUP_BLOCKS, place = thread % GROUP_BLOCKS;
    if (thread < CULL_GROUPS) drawn_masks[thread] = large_masks[thread] = 0;
    if (thread < 2) quartets[thread] = 0;
#ifdef HIZ
    if (thread == 0) candidate_total = 0;
#endif
    barrier();
    if (first + lane < end) {
        const uvec2 group = group_at(first + lane);
        bool large, look;
        if ((in_question(group) >> place & 1) != 0 &&
            is_selected(group_origin(group.x) + block_in_group(place), large, look)) {
#ifdef HIZ
            if (look) candidates[atomicAdd(candidate_total, 1)] = lane << 5 | place;
#endif
            if (!look) atomicOr(drawn_masks[lane], 1u << place);
            if (FOR_LARGE != 0 && large) atomicOr(large_masks[lane], 1u << place);
        }
    }
    barrier();
#ifdef HIZ
    // A team of threads for each candidate.
    for (uint i = thread / TEAM; i < candidate_total; i += CULL_GROUPS * GROUP_BLOCKS / TEAM) {
        const uint of = candidates[i] >> 5, at = candidates[i] & 31u;
        vec3 low, high;
        const uvec3 block = group_origin(group_at(first + of).x) + block_in_group(at);
        corners_of(block, uvec3(1), low, high);
        for (uint eye = 0; eye < EYES; ++eye)
            if ((EYES == 1 || in_frustum(eye, low, high)) &&  // of one, asked before
                is_in_sight(eye, low, high, thread % TEAM))
                atomicOr(drawn_masks[of], 1u << at);
    }
    barrier();
#endif
#ifdef SURFACES
    if (thread < CULL_GROUPS && first + thread < end) {
        const uint group = group_at(first + thread).x;
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
        widen(thread, first_entry[thread], first_entry[thread] + count);
    }
    if (thread == 0) {
        uint blocks = 0;
        for (uint i = 0; i < CULL_GROUPS; ++i) blocks += bitCount(drawn_masks[i]);
        if (blocks != 0) atomicAdd(counters.blocks_drawn, blocks);
    }
    barrier();
    if (mask != 0)
        list(size, first_entry[size] + number,
             (QUARTETS * group_at(first + of_group).x + quartet) << 4 | mask);
    barrier();
}

void main() {
    const uint thread = gl_LocalInvocationIndex;
    const uint step = SIFTS ? SIFTED : CULL_GROUPS;
    for (uint first = step * gl_WorkGroupID.x; first < group_count;
         first += step * gl_NumWorkGroups.x) {
        if (!SIFTS) {
            select_from(first, group_count);
            continue;
        }
        if (thread == 0) sifted_total = 0;
        barrier();
        if (thread < SIFTED && first + thread < group_count) sift(active_groups[first + thread]);
        barrier();
        for (uint i = 0; i < sifted_total; i += CULL_GROUPS) select_from(i, sifted_total);
        barrier();
    }
}
