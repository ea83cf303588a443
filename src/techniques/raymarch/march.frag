#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// variant march_numbered_frag: -DNUMBERED
// Thread: one ray. Out: the depth of the first hit, and the number of its surface: the paper's
// reference as the paper has it, in a fragment shader.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/ray.glsl"
#include "shaders/cell_root.glsl"
#include "shaders/march.glsl"

#ifdef NUMBERED
layout(location = 0) out uint surface_number;
#endif

layout(push_constant) uniform Push { uint eye; };

void main() {
    float t;
    uint number;
    if (!nearest_hit(pixel_ray(eye, gl_FragCoord.xy), t, number)) discard;
#ifdef NUMBERED
    surface_number = number;
#endif
    gl_FragDepth = clamp(reversed_depth(t), 1e-38, 1.0);
}
