// Whom a mesh shader's workgroup emits for. One eye; or both (STEREO), a copy of every vertex and
// triangle for each, into the layer that the triangle names; or the eye of the view that the device
// runs the workgroup for (MULTIVIEW).
// Before: const uint EYE_VERTICES, EYE_TRIANGLES: at most so many for an eye.
#if defined(STEREO)
const uint EYES = 2, FIRST_EYE = 0;
#elif defined(MULTIVIEW)
#extension GL_EXT_multiview : require
const uint EYES = 1;
#define FIRST_EYE uint(gl_ViewIndex)
#else
const uint EYES = 1, FIRST_EYE = 0;
#endif
layout(triangles, max_vertices = EYES * EYE_VERTICES, max_primitives = EYES * EYE_TRIANGLES) out;
out gl_MeshPerVertexEXT { vec4 gl_Position; } gl_MeshVerticesEXT[];
#ifdef STEREO
perprimitiveEXT out gl_MeshPerPrimitiveEXT {
    perprimitiveEXT int gl_Layer;
} gl_MeshPrimitivesEXT[];
layout(location = 2) perprimitiveEXT out uint eye_of_triangle[];
#endif

void set_layer(uint triangle, uint eye) {
#ifdef STEREO
    gl_MeshPrimitivesEXT[triangle].gl_Layer = int(eye);
    eye_of_triangle[triangle] = eye;
#endif
}
