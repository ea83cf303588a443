// What fragments of a surface share: their eye, and the clip planes.
#include "shaders/ray.glsl"

layout(constant_id = 1) const bool CLIPPED = false;  // without clip planes, depth is tested early

#if defined(STEREO)
#extension GL_EXT_mesh_shader : require
layout(location = 2) perprimitiveEXT flat in uint eye;
#elif defined(MULTIVIEW)
#extension GL_EXT_multiview : require
#define eye uint(gl_ViewIndex)
#else
const uint eye = 0;
#endif

void clip_fragment() {
    if (CLIPPED && !is_kept(eye, gl_FragCoord.xy, gl_FragCoord.z)) discard;
}
