#version 460
#extension GL_GOOGLE_include_directive : require
// variant build_pyramid_surfaces: -DSURFACES
// Workgroup: 32x32 pixels of one eye. Thread: 2x2 of them, or several such squares. Out: the
// farthest depth (least: depth is reversed) of squares of 2 to 32 pixels. SURFACES: of their pixels
// that have a surface; 0 only if none has.
#include "shaders/scene.glsl"
#include "shaders/pyramid.glsl"

layout(local_size_x_id = 1) in;
layout(constant_id = 2) const bool LOCKSTEP = false;
#include "shaders/lockstep.glsl"

layout(set = 1, binding = 0) uniform texture2DArray depth;
layout(set = 1, binding = 1, std430) writeonly buffer Pyramid { float pyramid[]; };

shared float farthest[16][16], thirds[4][4];  // squares of levels 1 and 3

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

// Of the finer squares in it: of level 1, or, above level 3, of level 3.
void build(uint level, uvec2 square) {
    const bool from_thirds = level > 3;
    const uint side = 1u << (from_thirds ? level - 3 : level - 1);
    float least = 1.0;
    for (uint i = 0; i < side * side; ++i) {
        const uvec2 finer = side * square + uvec2(i % side, i / side);
        const float depth = from_thirds ? thirds[finer.y][finer.x] : farthest[finer.y][finer.x];
        least = i == 0 ? depth : farther(least, depth);
    }
    if (level == 3) thirds[square.y][square.x] = least;
    store(level, gl_WorkGroupID.xy * (32u >> level) + square, least);
}

// Few barriers, as all of a workgroup wait at each: levels 2 and 3 from level 1, 4 and 5 from 3.
void main() {
    const uint threads = gl_WorkGroupSize.x, thread = gl_LocalInvocationIndex;
    for (uint i = thread; i < 256; i += threads) {
        const uvec2 place = uvec2(i % 16, i / 16), square = 16 * gl_WorkGroupID.xy + place;
        const uvec2 pixel = 2 * square;
        const float least =
            farther(farther(depth_at(pixel), depth_at(pixel + uvec2(1, 0))),
                    farther(depth_at(pixel + uvec2(0, 1)), depth_at(pixel + uvec2(1, 1))));
        store(1, square, least);
        farthest[place.y][place.x] = least;
    }
    wait_for_all();
    for (uint i = thread; i < 80; i += threads) {
        if (i < 64)
            build(2, uvec2(i % 8, i / 8));
        else
            build(3, uvec2(i % 4, i / 4 % 4));
    }
    wait_for_all();
    for (uint i = thread; i < 5; i += threads) {
        if (i < 4)
            build(4, uvec2(i % 2, i / 2));
        else
            build(5, uvec2(0));
    }
}
