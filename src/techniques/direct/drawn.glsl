// What a workgroup of a draw is to extract. Workgroups along x and y: a quartet; along z: the n-th of
// its drawn blocks.
layout(set = 1, binding = 0, std430) readonly buffer DrawnBlocks {
    uint quartet_count;
    uint drawn_quartets[];
};
layout(push_constant) uniform Push { uint draw, surface; };

bool my_block(uint n, out uvec3 block) {
    const uint i = draw * DRAW_QUARTETS + gl_WorkGroupID.x + DRAW_ROW * gl_WorkGroupID.y;
    return i < quartet_count && drawn_block(drawn_quartets[i], n, block);
}
