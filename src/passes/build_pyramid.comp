#version 460
#extension GL_GOOGLE_include_directive : require
// variant build_pyramid_surfaces: -DSURFACES
// Workgroup: 32x32 pixels of one eye. Thread: 2x2 of them. Out: the farthest depth (least: depth is
// reversed) of squares of 2 to 32 pixels. SURFACES: of their pixels that have a surface; 0 only if
// none has.
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

float farther(float a, float b) {
#ifdef SURFACES
    if (a == 0.0 || b == 0.0) return max(a, b);
#endif
    return min(a, b);
}

void store(uint level, uvec2 square, float value) {
    const uvec2 size = pyramid_size(level);
    const uint first = pyramid_offset(gl_GlobalInvocationID.z, level);
    if (all(lessThan(square, size))) pyramid[first + square.x + size.x * square.y] = value;
}

void main() {
    const uvec2 thread = gl_LocalInvocationID.xy, pixel = 2 * gl_GlobalInvocationID.xy;
    float least = farther(farther(depth_at(pixel), depth_at(pixel + uvec2(1, 0))),
                          farther(depth_at(pixel + uvec2(0, 1)), depth_at(pixel + uvec2(1, 1))));
    store(1, gl_GlobalInvocationID.xy, least);
    farthest[thread.y][thread.x] = least;
    for (uint level = 2; level <= PYRAMID_LEVELS; ++level) {
        // Squares of this level are threads whose coordinates are multiples of `step`.
        const uint step = 1u << (level - 1), half_step = step / 2;
        barrier();
        if (any(notEqual(thread % step, uvec2(0)))) continue;
        least = farther(
            farther(farthest[thread.y][thread.x], farthest[thread.y][thread.x + half_step]),
            farther(farthest[thread.y + half_step][thread.x],
                    farthest[thread.y + half_step][thread.x + half_step]));
        farthest[thread.y][thread.x] = least;
        store(level, gl_GlobalInvocationID.xy / step, least);
    }
}
