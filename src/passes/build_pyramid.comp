#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Workgroup: 64x64 pixels of one eye. Thread: 4x4 of them. Out: the farthest depth (least: depth is
// reversed) of squares of 2 to 64 pixels.
#include "shaders/scene.glsl"
#include "shaders/pyramid.glsl"

layout(local_size_x = 16, local_size_y = 16) in;

layout(set = 1, binding = 0) uniform texture2DArray depth;
layout(set = 1, binding = 1, std430) writeonly buffer Pyramid { float pyramid[]; };

shared float farthest[16][16];

// Beyond the picture lies its last pixel again, which changes no minimum.
float depth_at(uvec2 pixel) {
    return texelFetch(depth, ivec3(min(pixel, frame.size.xy - 1), gl_GlobalInvocationID.z), 0).r;
}

void store(uint level, uvec2 square, float value) {
    const uvec2 size = pyramid_size(level);
    const uint first = pyramid_offset(gl_GlobalInvocationID.z, level);
    if (all(lessThan(square, size))) pyramid[first + square.x + size.x * square.y] = value;
}

void main() {
    const uvec2 thread = gl_LocalInvocationID.xy, corner = 4 * gl_GlobalInvocationID.xy;
    float pixels[16];
    [[unroll]] for (uint i = 0; i < 16; ++i) pixels[i] = depth_at(corner + uvec2(i & 3, i >> 2));
    float least = 1.0;
    [[unroll]] for (uint i = 0; i < 4; ++i) {
        const uvec2 square = 2 * uvec2(i & 1, i >> 1);
        const uint first = square.x + 4 * square.y;
        const float value = min(min(pixels[first], pixels[first + 1]),
                                min(pixels[first + 4], pixels[first + 5]));
        store(1, (corner + square) / 2, value);
        least = min(least, value);
    }
    store(2, gl_GlobalInvocationID.xy, least);
    farthest[thread.y][thread.x] = least;
    for (uint level = 3; level <= PYRAMID_LEVELS; ++level) {
        // Squares of this level are threads whose coordinates are multiples of `step`.
        const uint step = 1u << (level - 2), half_step = step / 2;
        barrier();
        if (any(notEqual(thread % step, uvec2(0)))) continue;
        least = min(min(farthest[thread.y][thread.x], farthest[thread.y][thread.x + half_step]),
                    min(farthest[thread.y + half_step][thread.x],
                        farthest[thread.y + half_step][thread.x + half_step]));
        farthest[thread.y][thread.x] = least;
        store(level, gl_GlobalInvocationID.xy / step, least);
    }
}
