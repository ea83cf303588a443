// The most vertices and triangles of a mesh workgroup. Task and mesh shader must agree. Output memory is
// what limits mesh shaders (Elliott 2022, table 4.7): fewer is faster down to where sharing suffers.
#ifndef MAX_VERTICES
#define MAX_VERTICES 64
#define MAX_TRIANGLES 126
#endif
