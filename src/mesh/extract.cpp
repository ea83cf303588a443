// SPDX-License-Identifier: MIT
// From a volume to meshes: extract on the GPU, weld, place in the world.
#include <fmt/format.h>
#include <isorast/error.h>
#include <isorast/mesh.h>
#include <isorast/series.h>

#include <cmath>

#include "mesh/weld.h"
#include "passes/surface.h"

namespace isorast {

namespace {

using glm::dmat3;
using glm::dvec3;

dmat3 linear_part(const Affine& affine) {
    dmat3 m;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            m[column][row] = affine.m[row][column];
    return m;
}

dvec3 to_vec(const std::array<double, 3>& v) {
    return {v[0], v[1], v[2]};
}

bool at_border(const glm::vec3& p, const glm::uvec3& voxels) {
    for (int axis = 0; axis < 3; ++axis)
        if (p[axis] == 0 || p[axis] == float(voxels[axis] - 1)) return true;
    return false;
}

// The mean direction of the triangles around each vertex, for those where the field has no
// gradient.
std::vector<dvec3> directions_of_triangles(const Mesh& mesh) {
    std::vector<dvec3> sums(mesh.positions.size(), dvec3(0));
    for (const auto& triangle : mesh.triangles) {
        const dvec3 a = to_vec(mesh.positions[triangle[0]]);
        const dvec3 cross = glm::cross(to_vec(mesh.positions[triangle[1]]) - a,
                                       to_vec(mesh.positions[triangle[2]]) - a);
        for (const uint32_t corner : triangle)
            sums[corner] += cross;
    }
    return sums;
}

std::array<float, 3> unit(const dvec3& v) {
    const dvec3 n = glm::normalize(v);
    return {float(n.x), float(n.y), float(n.z)};
}

void add_normals(Mesh& mesh, const Surface& surface, const dmat3& linear) {
    const dmat3 normal_from_voxel = glm::transpose(glm::inverse(linear));
    std::vector<uint32_t> without;
    for (uint32_t i = 0; i < surface.gradients.size(); ++i) {
        const dvec3 outward = -(normal_from_voxel * dvec3(surface.gradients[i]));
        const double length = glm::length(outward);
        const bool is_known = length > 0 && std::isfinite(length);
        mesh.normals.push_back(is_known ? unit(outward) : std::array<float, 3>{0, 0, 1});
        if (!is_known) without.push_back(i);
    }
    if (without.empty()) return;
    const auto directions = directions_of_triangles(mesh);
    for (const uint32_t i : without)
        if (glm::length(directions[i]) > 0) mesh.normals[i] = unit(directions[i]);
}

Mesh in_world(const Surface& surface, const Volume& volume) {
    Mesh mesh;
    mesh.length_units = volume.length_units;
    const glm::uvec3 voxels(volume.dims[0], volume.dims[1], volume.dims[2]);
    mesh.positions.reserve(surface.positions.size());
    for (const glm::vec3& p : surface.positions) {
        mesh.positions.push_back(volume.affine(p.x, p.y, p.z));
        if (at_border(p, voxels)) mesh.closed = false;
    }
    // A mirrored grid turns clockwise into counter-clockwise.
    const bool mirrored = volume.affine.determinant() < 0;
    mesh.triangles.reserve(surface.triangles.size());
    for (const glm::uvec3& t : surface.triangles)
        mesh.triangles.push_back({t.x, mirrored ? t.z : t.y, mirrored ? t.y : t.z});
    add_normals(mesh, surface, linear_part(volume.affine));
    return mesh;
}

}  // namespace

std::vector<Mesh> extract_meshes(Gpu& gpu, const Volume& volume,
                                 const std::vector<double>& isovalues, const MeshOptions& options) {
    check(volume);
    for (const double isovalue : isovalues)
        if (!std::isfinite(isovalue))
            throw Error("isovalues: expected finite numbers, found NaN or infinity");
    const Grid grid(gpu.device(), series_of({&volume, 1}), options.max_brick_side,
                    /* step_bytes= */ 0);
    const SurfaceExtractor extractor(grid, /* gradients= */ true);
    std::vector<Mesh> meshes;
    for (const double isovalue : isovalues) {
        Surface surface = extractor.extract(grid.stored().from_value(isovalue));
        weld(surface, grid.info().voxels);
        meshes.push_back(in_world(surface, volume));
        meshes.back().name = fmt::format("iso {:.9g}", isovalue);
    }
    return meshes;
}

Mesh extract_mesh(Gpu& gpu, const Volume& volume, double isovalue, const MeshOptions& options) {
    return std::move(extract_meshes(gpu, volume, {isovalue}, options).front());
}

}  // namespace isorast
