// Lists of blocks. Active groups: the isovalue's, each a group's number and a mask of its active
// blocks. Drawn blocks: the frame's, in chunks of 32768 blocks, each entry the block's place in its
// chunk.

// A surface's active groups, set 1, binding 0. Define ACTIVE_GROUPS_ACCESS to write them.
#ifndef ACTIVE_GROUPS_ACCESS
#define ACTIVE_GROUPS_ACCESS readonly
#endif
layout(set = 1, binding = 0, std430) ACTIVE_GROUPS_ACCESS buffer ActiveGroups {
    uint cull_x, cull_y, cull_z;  // workgroups of the cull pass: one a group at a time
    uint group_count;
    uint task_x, task_y, task_z;  // task workgroups of the raster proxies: eight groups each
    uint unused;
    uvec2 active_groups[];  // group, mask
};
const uint TASK_GROUPS = 8, TASK_ROW = 32768;

// The first block of a group.
uvec3 group_origin(uint group) {
    const uvec3 where = uvec3(group % grid.groups.x, group / grid.groups.x % grid.groups.y,
                              group / (grid.groups.x * grid.groups.y));
    return where * uvec3(GROUP_X, GROUP_Y, GROUP_Z);
}

// A block's place in its group, x fastest.
uvec3 block_in_group(uint place) {
    return uvec3(place % GROUP_X, place / GROUP_X % GROUP_Y, place / (GROUP_X * GROUP_Y));
}
