#version 460
#extension GL_GOOGLE_include_directive : require
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

void main() {
    const Ray ray = pixel_ray(gl_FragCoord.xy);
    float nearest = 0.0;
    for (uint i = 0; i < frame.size.z; ++i) {
        float t;
        if (!first_hit(ray, frame.surfaces[i].w, t)) continue;
        const float z = clamp(reversed_depth(t), 1e-38, 1.0);
        if (z > nearest) {
            nearest = z;
#ifdef NUMBERED
            surface_number = i;
#endif
        }
    }
    if (nearest == 0.0) discard;
    gl_FragDepth = nearest;
}
