#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: 8x8 pixels. Thread: one ray. Out: the depth of the first hit, and the number of its
// surface.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/ray.glsl"
#include "shaders/cell_root.glsl"
#include "shaders/march.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 1, binding = 0, r32f) uniform image2D depth;
layout(set = 1, binding = 1, r32ui) writeonly uniform uimage2D surface_numbers;

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, ivec2(frame.size.xy)))) return;
    const Ray ray = pixel_ray(vec2(pixel) + 0.5);
    float nearest = 0.0;
    uint number = 0;
    for (uint i = 0; i < frame.size.z; ++i) {
        float t;
        if (!first_hit(ray, frame.surfaces[i].w, t)) continue;
        const float z = clamp(reversed_depth(t), 1e-38, 1.0);
        if (z > nearest) {
            nearest = z;
            number = i;
        }
    }
    imageStore(depth, pixel, vec4(nearest));
    if (frame.size.z > 1) imageStore(surface_numbers, pixel, uvec4(number));
}
