#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: 8x8 rays, each in the middle of a square of pixels. Thread: one ray. Out: the block
// that it hits, as visible: a guess, after a change.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/ray.glsl"
#include "shaders/cell_root.glsl"
#include "shaders/march.glsl"
#define VISIBLE_BLOCKS_BINDING 0
#include "shaders/visible_blocks.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(push_constant) uniform Push { int side; };  // of a square

void main() {
    const ivec2 middle = side * ivec2(gl_GlobalInvocationID.xy) + side / 2;
    if (any(greaterThanEqual(middle, ivec2(frame.size.xy)))) return;
    const Ray ray = pixel_ray(gl_GlobalInvocationID.z, vec2(middle));  // z: the eye
    float t;
    uint number;
    if (nearest_hit(ray, t, number)) mark_visible(cell_of(ray.origin + t * ray.direction));
}
