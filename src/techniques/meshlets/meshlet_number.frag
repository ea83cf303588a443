#version 460
#extension GL_GOOGLE_include_directive : require
// Thread: one fragment. Out: the number of its surface; only drawn where there are several
// surfaces.
#include "techniques/meshlets/payload.glsl"
layout(location = 0) out uint surface_number;
void main() { surface_number = surface; }
