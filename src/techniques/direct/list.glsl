// Lists of blocks. Active groups: the isovalue's, each a group's number and a mask of its active
// blocks. Drawn blocks: the frame's, in chunks of 32768 blocks, each entry the block's place in its
// chunk.

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
