// SPDX-License-Identifier: MIT
// The formats that meshes can be written in.
#pragma once
#include <isorast/mesh.h>

#include "image/whole_file.h"

namespace isorast {

// "isorast, iso 300, lengths in mm".
std::string describe(const Mesh& mesh);

// Whether positions less `origin`, as 32-bit floats, leave each triangle three different corners.
bool floats_suffice(const Mesh& mesh, const std::array<double, 3>& origin = {});
// Throws Error with another format to use unless they do.
void require_floats(const std::string& path, const Mesh& mesh,
                    const std::array<double, 3>& origin = {});
std::array<float, 3> as_floats(const std::array<double, 3>& position,
                               const std::array<double, 3>& origin = {});

void write_stl(const std::string& path, const Mesh& mesh);
void write_ply(const std::string& path, const Mesh& mesh);
void write_obj(const std::string& path, const std::vector<Mesh>& meshes);
void write_glb(const std::string& path, const std::vector<Mesh>& meshes);

}  // namespace isorast
