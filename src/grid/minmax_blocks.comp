#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: one block. Thread: a share of its 9^3 voxels. Out: the block's min-max, apron
// included, as node of level 0 (Kreskowski 2022, section 3.3).
#define SCENE_WRITES_MINMAX
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "grid/store_node.glsl"

layout(local_size_x = 64) in;

shared float lows[64], highs[64];

void main() {
    const ivec3 first = ivec3(gl_WorkGroupID * BLOCK);
    const Brick brick = brick_of(first);
    const uint thread = gl_LocalInvocationIndex;
    const uint side = BLOCK + 1;
    float low = 3.402823466e38, high = -3.402823466e38;
    for (uint i = thread; i < side * side * side; i += 64) {
        const ivec3 corner = ivec3(i % side, i / side % side, i / (side * side));
        const float value = voxel(brick, clamp_to_volume(first + corner));
        low = min(low, value);
        high = max(high, value);
    }
    lows[thread] = low;
    highs[thread] = high;
    for (uint half_count = 32; half_count > 0; half_count /= 2) {
        barrier();
        if (thread < half_count) {
            lows[thread] = min(lows[thread], lows[thread + half_count]);
            highs[thread] = max(highs[thread], highs[thread + half_count]);
        }
    }
    if (thread == 0) store_node(node_index(0, gl_WorkGroupID), vec2(lows[0], highs[0]));
}
