// The list of drawn blocks, and what a workgroup of a draw is to extract. Workgroups along x and y:
// a quartet and each MOST-th one after it, or that one alone if MOST is 0; along z: the n-th of its
// drawn blocks. Blocks that are large in the picture are listed from the list's end backwards:
// define LARGE to draw those. Needs MOST; PUSHED_TOO: what else is pushed.

layout(set = 1, binding = 0, std430) readonly buffer Draws { Draw draws[]; };
layout(set = 1, binding = 1, std430) readonly buffer DrawnBlocks { uint drawn_quartets[]; };
layout(push_constant) uniform Push {
    uint first_entry;  // of this draw
    uint surface;
    uint first_draw;
#ifdef PUSHED_TOO
    PUSHED_TOO
#endif
};

// The n-th of a workgroup's quartets; false if there are fewer.
bool my_quartet(uint n, out uint entry) {
    const uint i = first_entry + gl_WorkGroupID.x + DRAW_ROW * gl_WorkGroupID.y + MOST * n;
    // Both on their way before either is waited for.
    const uint last = drawn_quartets.length() - 1, count = draws[first_draw].quartets;
#ifdef LARGE
    entry = drawn_quartets[last - min(i, last)];
#else
    entry = drawn_quartets[min(i, last)];
#endif
    return i < count;
}
