#version 460
#extension GL_EXT_mesh_shader : require
// Thread: a fragment of a block's proxy that nothing drawn so far hides. Out: the block, as visible
// (Kreskowski 2022, section 3.5.2).
layout(early_fragment_tests) in;
layout(location = 0) perprimitiveEXT flat in uint block;  // group << 5 | place

layout(set = 1, binding = 2, std430) buffer TestedBlocks { uint tested_blocks[]; };

void main() {
    const uint bit = 1u << (block & 31u);
    if ((tested_blocks[block >> 5] & bit) == 0) atomicOr(tested_blocks[block >> 5], bit);
}
