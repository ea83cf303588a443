// What task and mesh shaders share: a block, from one to the other, as signs.
#include "techniques/direct/limits.glsl"
#include "techniques/direct/block_lists.glsl"

layout(local_size_x = 32) in;
const uint THREADS = gl_WorkGroupSize.x, SIGN_WORDS = 27;

// 136 bytes for 8^3 cells, where the paper's interface block takes 324 for half of them. Row r of
// cells is bit r % 32 of the word r / 32.
struct Payload {
    uint first_cell[3];      // the block's lowest corner
    uint row_starts[2];      // a mesh workgroup begins at this row
    uint row_splits[2];      // this row alone has two workgroups, for x < 4 and x >= 4
    uint signs[SIGN_WORDS];  // three corner rows of 9 bits a word
};

shared uint sums[2][THREADS];

// The sum of `mine` over this thread and those before it; `total`: over all. And a barrier. Through
// shared memory, unless the threads are one subgroup of a device that can add across it.
uint sum_up_to(uint mine, out uint total) {
#ifdef SUBGROUPS
    if (gl_NumSubgroups == 1) {
        const uint sum = subgroupInclusiveAdd(mine);
        total = subgroupBroadcast(sum, THREADS - 1);
        barrier();
        return sum;
    }
#endif
    const uint thread = gl_LocalInvocationIndex;
    uint sum = mine, from = 0;
    sums[0][thread] = mine;
    barrier();
    for (uint step = 1; step < THREADS; step *= 2) {
        if (thread >= step) sum += sums[from][thread - step];
        from = 1 - from;
        sums[from][thread] = sum;
        barrier();
    }
    total = sums[from][THREADS - 1];
    return sum;
}
