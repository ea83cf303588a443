// SPDX-License-Identifier: MIT
// From a file's ending to its format, and what the formats share.
#include <fmt/format.h>
#include <isorast/error.h>

#include <filesystem>

#include "mesh/formats.h"
#include "volume/text.h"

namespace isorast {

namespace {

std::string ending_of(const std::string& path) {
    return lowercase(std::filesystem::path(path).extension().string());
}

}  // namespace

std::string describe(const Mesh& mesh) {
    return fmt::format(
        "isorast, {}, {}", mesh.name,
        mesh.length_units.empty() ? "lengths in unknown units" : "lengths in " + mesh.length_units);
}

std::array<float, 3> as_floats(const std::array<double, 3>& position,
                               const std::array<double, 3>& origin) {
    return {float(position[0] - origin[0]), float(position[1] - origin[1]),
            float(position[2] - origin[2])};
}

bool floats_suffice(const Mesh& mesh, const std::array<double, 3>& origin) {
    for (const auto& triangle : mesh.triangles) {
        const auto a = as_floats(mesh.positions[triangle[0]], origin);
        const auto b = as_floats(mesh.positions[triangle[1]], origin);
        const auto c = as_floats(mesh.positions[triangle[2]], origin);
        if (a == b || b == c || c == a) return false;
    }
    return true;
}

void require_floats(const std::string& path, const Mesh& mesh,
                    const std::array<double, 3>& origin) {
    if (!floats_suffice(mesh, origin))
        throw Error(fmt::format(
            "{}: expected coordinates that 32-bit floats can tell apart, found vertices too close "
            "together so far from the origin; write .obj, whose numbers have all digits",
            path));
}

std::string why_not_writable(const std::string& path, size_t meshes) {
    const std::string ending = ending_of(path);
    if (ending == ".obj" || ending == ".glb") return "";
    if (ending != ".stl" && ending != ".ply")
        return fmt::format("{}: expected a file ending in .stl, .ply, .obj or .glb", path);
    if (meshes == 1) return "";
    return fmt::format("{}: {} holds one surface, found {} isovalues; write .obj or .glb", path,
                       ending == ".stl" ? "STL" : "PLY", meshes);
}

void write_meshes(const std::string& path, const std::vector<Mesh>& meshes) {
    if (const std::string why = why_not_writable(path, meshes.size()); !why.empty())
        throw Error(why);
    const std::string ending = ending_of(path);
    if (ending == ".stl") return write_stl(path, meshes.front());
    if (ending == ".ply") return write_ply(path, meshes.front());
    if (ending == ".obj") return write_obj(path, meshes);
    write_glb(path, meshes);
}

void write_mesh(const std::string& path, const Mesh& mesh) {
    write_meshes(path, {mesh});
}

}  // namespace isorast
