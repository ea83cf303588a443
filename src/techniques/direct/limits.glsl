// The most vertices and triangles of a mesh workgroup; task and mesh shader must agree. Output
// memory is what limits mesh shaders (Elliott 2022, table 4.7): fewer is faster down to where
// sharing suffers. At least 36 vertices and 20 triangles: half a cell row with every corner unlike
// its neighbours.
const uint MAX_VERTICES = 64, MAX_TRIANGLES = 126;

// Blocks whose extent in the picture is larger (pixels) are large to the compute rasterizer: there
// its threads share out pixels in place of triangles. Below 128, so that the edge functions of a
// small block's triangles, on a grid of 1/256 pixels, fit 32 bits. Large is also what lies beyond
// GUARD pixels, or before the near plane, where triangles may need clipping.
const float SMALL_SIDE = 120.0, GUARD = 16384.0;
