#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: 8x8 rays, each in the middle of 2x2 pixels. Thread: one ray. Out: the block that it
// hits, as visible: a first guess after a cut, when no frame before says what is visible.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/ray.glsl"
#include "shaders/cell_root.glsl"
#include "shaders/march.glsl"
#define VISIBLE_BLOCKS_BINDING 0
#include "shaders/visible_blocks.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
    const uvec2 pixel = 2 * gl_GlobalInvocationID.xy + 1;
    if (any(greaterThanEqual(pixel, frame.size.xy))) return;
    const Ray ray = pixel_ray(gl_GlobalInvocationID.z, vec2(pixel));
    float t;
    uint number;
    if (nearest_hit(ray, t, number)) mark_visible(cell_of(ray.origin + t * ray.direction));
}
