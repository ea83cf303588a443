#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: 4 groups of 32 blocks. Thread: one block. Out: the groups that hold a block which the
// isovalue crosses, each with a mask of such blocks (Kreskowski 2022, section 3.5.1, once an
// isovalue).
#include "shaders/scene.glsl"
#include "techniques/direct/list.glsl"
#define ACTIVE_GROUPS_ACCESS
#include "techniques/direct/active_groups.glsl"

layout(local_size_x = 128) in;

layout(set = 1, binding = 1, std430) buffer CounterBlock { Counters counters; };
layout(push_constant) uniform Push {
    float iso;
    uint groups_in_row;   // workgroups along x
    uint groups_at_once;  // of a workgroup of the cull pass
};

shared uint masks[4];

void main() {
    const uint local_group = gl_LocalInvocationIndex / GROUP_BLOCKS;
    const uint place = gl_LocalInvocationIndex % GROUP_BLOCKS;
    const uint group = 4 * (gl_WorkGroupID.x + groups_in_row * gl_WorkGroupID.y) + local_group;
    const uvec3 block = group_origin(group) + block_in_group(place);
    if (place == 0) masks[local_group] = 0;
    barrier();
    if (group < grid.groups.w && all(lessThan(block, grid.blocks.xyz)) &&
        crosses(node_range(node_index(0, block)), iso))
        atomicOr(masks[local_group], 1u << place);
    barrier();
    if (place != 0 || masks[local_group] == 0) return;
    const uint slot = atomicAdd(group_count, 1);
    active_groups[slot] = uvec2(group, masks[local_group]);
    if (slot % groups_at_once == 0 && slot / groups_at_once < MAX_LIST_GROUPS) atomicAdd(cull_x, 1);
    if (slot % TASK_GROUPS == 0) {
        const uint task = slot / TASK_GROUPS;
        if (task < TASK_ROW) atomicAdd(task_x, 1);
        if (task % TASK_ROW == 0) atomicAdd(task_y, 1);
    }
    atomicAdd(counters.blocks_active, bitCount(masks[local_group]));
}
