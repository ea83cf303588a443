#version 460
// Thread: one fragment. Out: the number of its surface; only drawn where there are several
// surfaces.
layout(location = 0) out uint surface_number;
layout(push_constant) uniform Push { uint chunk, surface; };
void main() { surface_number = surface; }
