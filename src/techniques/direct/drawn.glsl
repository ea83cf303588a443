// The list of drawn blocks, and what a workgroup of a draw is to extract. Workgroups along x and y:
// a quartet; along z: the n-th of its drawn blocks. Blocks that are large in the picture are listed
// from the list's end backwards: define LARGE to draw those.

layout(set = 1, binding = 0, std430) readonly buffer Draws { Draw draws[]; };
layout(set = 1, binding = 1, std430) readonly buffer DrawnBlocks { uint drawn_quartets[]; };
layout(push_constant) uniform Push {
    uint draw;  // counted from the list's first
    uint surface;
    uint first_draw;
};

bool my_quartet(out uint entry) {
    const uint i = draw * DRAW_QUARTETS + gl_WorkGroupID.x + DRAW_ROW * gl_WorkGroupID.y;
    // Both on their way before either is waited for.
    const uint last = drawn_quartets.length() - 1, count = draws[first_draw].quartets;
#ifdef LARGE
    entry = drawn_quartets[last - min(i, last)];
#else
    entry = drawn_quartets[min(i, last)];
#endif
    return i < count;
}
