#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: 8x8 rays, each in the middle of a square of pixels. Thread: one ray. Out: the block that
// it hits, as visible: a guess, after a change. First a few rays everywhere; then one for 2x2 pixels
// where blocks seen so far leave one of them without a surface, and where that is new: through a
// hole that stays open, everything behind it would be drawn.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/ray.glsl"
#include "shaders/cell_root.glsl"
#include "shaders/march.glsl"
#include "shaders/pyramid.glsl"
#define VISIBLE_BLOCKS_BINDING 0
#include "shaders/visible_blocks.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 1, binding = 1) uniform texture2DArray depth;
// As the last frame has left it.
layout(set = 1, binding = 2, std430) readonly buffer Pyramid { float pyramid[]; };
layout(push_constant) uniform Push {
    int side;         // of a square
    bool uncovered;   // only where there is no surface; of squares of 2x2
    bool remembered;  // the pyramid is there
};

bool is_uncovered(uvec3 square) {
    const ivec3 pixel = ivec3(2 * square.xy, square.z);
    float farthest = 1.0;
    for (int i = 0; i < 4; ++i)
        farthest = min(farthest, texelFetch(depth, pixel + ivec3(i & 1, i >> 1, 0), 0).r);
    return farthest == 0.0;
}

bool was_uncovered(uvec3 square) {
    return remembered && pyramid[pyramid_offset(square.z, 1) + square.x +
                                 pyramid_size(1).x * square.y] == 0.0;
}

void main() {
    const uvec3 square = gl_GlobalInvocationID;  // z: the eye
    const ivec2 middle = side * ivec2(square.xy) + side / 2;
    if (any(greaterThanEqual(middle, ivec2(frame.size.xy)))) return;
    if (uncovered && (was_uncovered(square) || !is_uncovered(square))) return;
    const Ray ray = pixel_ray(square.z, vec2(middle));
    float t;
    uint number;
    if (nearest_hit(ray, t, number)) mark_visible(cell_of(ray.origin + t * ray.direction));
}
