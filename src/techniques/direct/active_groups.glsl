// A surface's active groups, set 1, binding 0. Define ACTIVE_GROUPS_ACCESS to write them.
#ifndef ACTIVE_GROUPS_ACCESS
#define ACTIVE_GROUPS_ACCESS readonly
#endif
layout(set = 1, binding = 0, std430) ACTIVE_GROUPS_ACCESS buffer ActiveGroups {
    uint cull_x, cull_y, cull_z;  // workgroups of the cull pass: 4 or SIFTED groups at a time
    uint group_count;
    uint task_x, task_y, task_z;  // task workgroups of the raster proxies: eight groups each
    uint unused;
    uvec2 active_groups[];  // group, mask
};
const uint TASK_GROUPS = 8, TASK_ROW = 32768;
