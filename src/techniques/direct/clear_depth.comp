#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: 32x32 pixels of one eye. Thread: 4x4 of them, eight apart. Out: depth 0. For GPUs:
// there clearing by a command is fixed-function work, forty times slower if graphics is throttled.
#include "shaders/scene.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 1, binding = 0, r32ui) writeonly uniform uimage2DArray depth_bits;

void main() {
    const uvec2 first = 32 * gl_WorkGroupID.xy + gl_LocalInvocationID.xy;
    for (uint i = 0; i < 16; ++i) {
        const uvec2 pixel = first + 8 * uvec2(i & 3, i >> 2);
        if (all(lessThan(pixel, frame.size.xy)))
            imageStore(depth_bits, ivec3(pixel, gl_GlobalInvocationID.z), uvec4(0));
    }
}
