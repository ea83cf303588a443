#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Workgroup: 8x8 pixels of one eye. Thread: one ray. Out: the depth of the first hit, and the
// number of its surface.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/ray.glsl"
#include "shaders/cell_root.glsl"
#include "shaders/march.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 1, binding = 0, r32f) writeonly uniform image2DArray depth;
layout(set = 1, binding = 1, r32ui) writeonly uniform uimage2DArray surface_numbers;

void main() {
    const ivec3 pixel = ivec3(gl_GlobalInvocationID);  // z: the eye
    if (any(greaterThanEqual(pixel.xy, ivec2(frame.size.xy)))) return;
    float t;
    uint number;
    const bool found = nearest_hit(pixel_ray(pixel.z, vec2(pixel.xy) + 0.5), t, number);
    const float z = found ? clamp(reversed_depth(t), 1e-38, 1.0) : 0.0;
    imageStore(depth, pixel, vec4(z));
    if (frame.size.z > 1) imageStore(surface_numbers, pixel, uvec4(number));
}
