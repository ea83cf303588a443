// SPDX-License-Identifier: MIT
// Isosurfaces as meshes, and the files that hold them. Needs a device with compute, but no mesh
// shaders; part of the core.
#pragma once
#include <isorast/gpu.h>
#include <isorast/volume.h>

#include <array>
#include <string>
#include <vector>

namespace isorast {

// Every edge is shared by exactly two triangles, and by one only at the volume's border; no two
// vertices lie at the same place, and no triangle has two corners there.
struct Mesh {
    std::vector<std::array<double, 3>> positions;    // world
    std::vector<std::array<float, 3>> normals;       // one a vertex; unit, towards lesser values
    std::vector<std::array<uint32_t, 3>> triangles;  // counter-clockwise seen from outside
    std::string name;                                // "iso 300": what groups in files are called
    std::string length_units;                        // of the world, as Volume::length_units
    bool closed = true;  // false where the surface ends at the volume's border
};

struct MeshOptions {
    uint32_t max_brick_side = 0;  // as in RendererOptions
};

// The whole surface at each isovalue (data units), as marching cubes: a vertex where an edge of the
// grid crosses the isovalue, by linear interpolation; inside is value >= isovalue. Parts without
// area, such as a lone voxel at the isovalue, are left out. The same volume gives the same mesh
// every time. Throws Error when the device cannot hold the volume, when its storage buffers are too
// small, for isovalues that are not finite, and for a surface of 2^32 or more vertices or
// triangles.
std::vector<Mesh> extract_meshes(Gpu& gpu, const Volume& volume,
                                 const std::vector<double>& isovalues,
                                 const MeshOptions& options = {});
Mesh extract_mesh(Gpu& gpu, const Volume& volume, double isovalue, const MeshOptions& options = {});

// The file's ending says which: .stl and .ply (binary, one mesh), .obj and .glb (glTF 2.0; a named
// object for each mesh). World coordinates as they are, but for .glb, whose root node turns them
// into what glTF wants: metres (where the units are known), with y up. The file appears whole or
// not at all. Throws Error for other endings, for several meshes where the format holds one, and
// where the format's 32-bit coordinates cannot tell neighbouring vertices apart.
void write_meshes(const std::string& path, const std::vector<Mesh>& meshes);
void write_mesh(const std::string& path, const Mesh& mesh);
// Empty when write_meshes can write `meshes` meshes to this path, else why not.
std::string why_not_writable(const std::string& path, size_t meshes);

}  // namespace isorast
