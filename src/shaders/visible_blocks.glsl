// Marks a block as visible: one bit, in the word of its group. Define VISIBLE_BLOCKS_BINDING (set
// 1) first.
layout(set = 1, binding = VISIBLE_BLOCKS_BINDING, std430) buffer VisibleBlocks {
    uint visible_blocks[];
};

void mark_visible(ivec3 cell) {
    const uvec3 block = uvec3(cell) / BLOCK;
    const uvec3 sides = uvec3(GROUP_X, GROUP_Y, GROUP_Z);
    const uvec3 group = block / sides, place = block % sides;
    const uint word = group.x + grid.groups.x * (group.y + grid.groups.y * group.z);
    const uint bit = 1u << (place.x + GROUP_X * (place.y + GROUP_Y * place.z));
    if ((visible_blocks[word] & bit) == 0) atomicOr(visible_blocks[word], bit);
}
