#version 460
#extension GL_GOOGLE_include_directive : require
// variant forward_stereo_frag: -DSTEREO
// variant forward_multiview_frag: -DMULTIVIEW
// Thread: one fragment. Out: its colour, from the mesh shader's normals: the paper's own way to
// shade (Kreskowski 2022, section 4, "Shading").
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/shading.glsl"
#include "shaders/fragment.glsl"

layout(location = 0) in vec3 position;  // voxel space
layout(location = 1) in vec3 gradient;
layout(location = 0) out vec4 color;
layout(push_constant) uniform Push { uint unused, surface; };  // as in drawn.glsl

void main() {
    clip_fragment();
    const vec3 direction = pixel_ray(eye, gl_FragCoord.xy).direction;
    const bool outward = dot(gradient, direction) > 0.0;
    color = vec4(gooch(frame.surfaces[surface].rgb, world_normal(gradient, direction, outward),
                       world_direction(direction)), 1.0);
}
