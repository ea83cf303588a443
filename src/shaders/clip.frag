#version 460
#extension GL_GOOGLE_include_directive : require
// variant clip_stereo_frag: -DSTEREO
// variant clip_multiview_frag: -DMULTIVIEW
// Thread: one fragment. Out: its depth, unless a clip plane cuts it off; only drawn where there are
// clip planes.
#include "shaders/scene.glsl"
#include "shaders/fragment.glsl"

void main() { clip_fragment(); }
