#version 460
#extension GL_GOOGLE_include_directive : require
// variant surface_number_stereo_frag: -DSTEREO
// variant surface_number_multiview_frag: -DMULTIVIEW
// Thread: one fragment. Out: the number of its surface; only drawn where there are several
// surfaces.
#include "shaders/scene.glsl"
#include "shaders/fragment.glsl"

layout(location = 0) out uint surface_number;
layout(push_constant) uniform Push { uint unused, surface; };  // as the task shader's begins

void main() {
    clip_fragment();
    surface_number = surface;
}
