// The most vertices and triangles of a mesh workgroup; task and mesh shader must agree. Output
// memory is what limits mesh shaders (Elliott 2022, table 4.7): fewer is faster down to where
// sharing suffers. At least 36 vertices and 20 triangles: half a cell row with every corner unlike
// its neighbours.
const uint MAX_VERTICES = 64, MAX_TRIANGLES = 126;
