// Lists of blocks. Active groups: the isovalue's, each a group's number and a mask of its active
// blocks. Drawn quartets: the frame's, each a quartet's number (8 * group + place) and a mask of
// its drawn blocks.

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

// A quartet's first block in its group: x and y are even.
uvec3 quartet_in_group(uint place) { return uvec3(2 * (place & 1u), place & 2u, place >> 2); }

// The mask of a quartet's blocks, from its group's.
uint quartet_mask(uint group_mask, uint place) {
    const uvec3 first = quartet_in_group(place);
    const uint bits = group_mask >> (first.x + GROUP_X * (first.y + GROUP_Y * first.z));
    return bits & 3u | bits >> GROUP_X - 2 & 12u;
}

// The n-th drawn block of a quartet (an entry of the list); false if it has fewer.
bool drawn_block(uint entry, uint n, out uvec3 block) {
    uint mask = entry & 15u;
    const uint quartet = entry >> 4;
    for (uint i = 0; i < n; ++i) mask &= mask - 1;
    const uint bit = uint(findLSB(mask));
    block = group_origin(quartet / QUARTETS) + quartet_in_group(quartet % QUARTETS) +
            uvec3(bit & 1u, bit >> 1 & 1u, 0);
    return mask != 0;
}
