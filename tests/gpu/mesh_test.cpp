// SPDX-License-Identifier: MIT
// Exported surfaces: manifold, welded, closed but for the volume's border, wound outward; also
// where voxels equal the isovalue. Runs on any device with compute.
#include <isorast/mesh.h>

#include <algorithm>
#include <map>
#include <set>

#include "gpu/gpu_fixture.h"

namespace {

using namespace isorast;
using namespace reference;

dvec3 corner(const Mesh& mesh, const std::array<uint32_t, 3>& triangle, size_t i) {
    return vector(mesh.positions[triangle[i]]);
}

dvec3 area_vector(const Mesh& mesh, const std::array<uint32_t, 3>& triangle) {
    const dvec3 a = corner(mesh, triangle, 0);
    return glm::cross(corner(mesh, triangle, 1) - a, corner(mesh, triangle, 2) - a) / 2.0;
}

double volume_within(const Mesh& mesh) {
    double sum = 0;
    for (const auto& triangle : mesh.triangles)
        sum += glm::dot(corner(mesh, triangle, 0), area_vector(mesh, triangle)) / 3;
    return sum;
}

using Edge = std::pair<uint32_t, uint32_t>;

// How often each edge is walked upwards and downwards in number.
std::map<Edge, std::array<int, 2>> edges_of(const Mesh& mesh) {
    std::map<Edge, std::array<int, 2>> edges;
    for (const auto& t : mesh.triangles)
        for (size_t i = 0; i < 3; ++i) {
            const uint32_t a = t[i], b = t[(i + 1) % 3];
            ++edges[{std::min(a, b), std::max(a, b)}][a < b ? 0 : 1];
        }
    return edges;
}

int64_t euler_characteristic(const Mesh& mesh) {
    return int64_t(mesh.positions.size()) - int64_t(edges_of(mesh).size()) +
           int64_t(mesh.triangles.size());
}

// On a face of the volume's box, in voxel space (the identity affine).
bool on_one_border(const Volume& volume, const dvec3& a, const dvec3& b) {
    for (int axis = 0; axis < 3; ++axis)
        for (const double face : {0.0, volume.dims[axis] - 1.0})
            if (a[axis] == face && b[axis] == face) return true;
    return false;
}

// Each edge has two triangles that walk it in opposite directions, or one at the volume's border.
void expect_manifold(const Mesh& mesh, const Volume& volume, const std::string& what) {
    uint64_t torn = 0, crowded = 0, flat = 0;
    for (const auto& [edge, walks] : edges_of(mesh)) {
        if (walks[0] == 1 && walks[1] == 1) continue;
        if (walks[0] + walks[1] > 1)
            ++crowded;
        else
            torn += !on_one_border(volume, vector(mesh.positions[edge.first]),
                                   vector(mesh.positions[edge.second]));
    }
    for (const auto& triangle : mesh.triangles)
        flat += !(glm::length(area_vector(mesh, triangle)) > 1e-8);
    EXPECT_EQ(torn, 0u) << what << ": edges of one triangle";
    EXPECT_EQ(crowded, 0u) << what << ": edges of other triangles than two that face alike";
    EXPECT_EQ(flat, 0u) << what << ": triangles without area";
    const std::set<std::array<double, 3>> places(mesh.positions.begin(), mesh.positions.end());
    EXPECT_EQ(places.size(), mesh.positions.size()) << what << ": vertices at one place";
    std::vector<bool> used(mesh.positions.size());
    for (const auto& triangle : mesh.triangles)
        for (const uint32_t vertex : triangle)
            used[vertex] = true;
    EXPECT_EQ(std::ranges::count(used, false), 0) << what << ": vertices of no triangle";
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size()) << what;
}

// Voxels drawn from `values`; zeros around them where `closed`.
Volume drawn(std::array<uint32_t, 3> dims, const std::vector<int>& values, uint32_t seed,
             bool closed) {
    std::mt19937 random(seed);
    return volume_of<uint8_t>(dims, VoxelType::u8, [&](uint32_t i, uint32_t j, uint32_t k) {
        const int value = values[random() % values.size()];
        const bool inner =
            i > 0 && j > 0 && k > 0 && i + 1 < dims[0] && j + 1 < dims[1] && k + 1 < dims[2];
        return inner || !closed ? value : 0;
    });
}

TEST_F(GpuTest, MeshOfRandomVoxelsIsManifold) {
    // Few, some or most voxels at the isovalue 100, and the rest below, above or both.
    const std::vector<std::vector<int>> draws{{0, 100},
                                              {0, 0, 0, 0, 0, 0, 100},
                                              {100, 100, 100, 100, 100, 0},
                                              {99, 100, 101},
                                              {0, 100, 100, 255},
                                              {100, 200},
                                              {0, 50, 99, 101, 150, 255},
                                              {0, 0, 0, 200}};
    for (size_t i = 0; i < draws.size(); ++i)
        for (const bool closed : {true, false}) {
            const Volume volume = drawn({19, 17, 18}, draws[i], uint32_t(i), closed);
            const Mesh mesh = extract_mesh(gpu, volume, 100);
            const std::string what = fmt::format("draw {}, closed {}", i, closed);
            expect_manifold(mesh, volume, what);
            EXPECT_TRUE(mesh.closed || !closed) << what;
            EXPECT_TRUE(!closed || mesh.triangles.size() > 100) << what;
            EXPECT_TRUE(!closed || volume_within(mesh) > 0) << what;
        }
}

TEST_F(GpuTest, MeshLeavesOutPointsAndLines) {
    // A voxel at the isovalue; a row of three; both far from each other.
    const auto alone = [](uint32_t i, uint32_t j, uint32_t k) {
        return (j == 4 && k == 4 && (i == 2 || (i > 4 && i < 8))) ? 100 : 0;
    };
    const Volume volume = volume_of<uint8_t>({10, 9, 9}, VoxelType::u8, alone);
    EXPECT_TRUE(extract_mesh(gpu, volume, 100).triangles.empty());
    EXPECT_EQ(extract_mesh(gpu, volume, 99).triangles.size(), 4 * 8u);
}

TEST_F(GpuTest, MeshesHaveTheTopologyOfTheirFormula) {
    for (const auto& [name, level, expected] : {std::tuple{"sphere:40", 0.25, 2},
                                                {"torus:40", 0.0, 0},
                                                {"torus:40x40x33:type=u8", 0.0, 0}}) {
        const Volume volume = make_procedural(name);
        const Mesh mesh = extract_mesh(gpu, volume, level);
        EXPECT_EQ(euler_characteristic(mesh), expected) << name;
        EXPECT_TRUE(mesh.closed) << name;
        EXPECT_EQ(mesh.name, fmt::format("iso {:.9g}", level));
    }
    const Mesh gyroid = extract_mesh(gpu, make_procedural("gyroid:33"), 0);
    EXPECT_FALSE(gyroid.closed);
}

TEST_F(GpuTest, MeshIsTheFormulasSphereInTheWorld) {
    // The radius at level 0.25 is 0.75, in the formula's coordinates.
    Volume volume = sampled("sphere:48");
    const double half = 23.5;  // voxels from the middle to the border
    for (const bool mirrored : {false, true}) {
        volume.affine.m = {
            {{0.8, 0.6, 0, 1000}, {-0.6, 0.8, 0, -3}, {0, 0, mirrored ? -1.0 : 1.0, 5}}};
        const Mesh mesh = extract_mesh(gpu, volume, 0.25);
        const double radius = 0.75 * half;
        const dvec3 middle = vector(volume.affine(half, half, half));
        for (size_t i = 0; i < mesh.positions.size(); ++i) {
            const dvec3 out = vector(mesh.positions[i]) - middle;
            ASSERT_NEAR(glm::length(out), radius, 0.01);
            const auto& n = mesh.normals[i];
            ASSERT_GT(glm::dot(dvec3(n[0], n[1], n[2]), out / glm::length(out)), 0.999);
        }
        Mesh centred = mesh;
        for (auto& p : centred.positions)
            for (int axis = 0; axis < 3; ++axis)
                p[axis] -= middle[axis];
        EXPECT_NEAR(volume_within(centred), 4.18879 * radius * radius * radius, 60) << mirrored;
    }
}

TEST_F(GpuTest, MeshDoesNotDependOnBricks) {
    if (!gpu.device().features().nonuniform_textures) GTEST_SKIP();
    for (const std::string name : {"noise:41x50x65:octaves=3:type=u8", "gyroid:50x41x33"}) {
        const Volume volume = sampled(name);
        const double level = suggest_isovalue(volume, statistics(volume));
        const Mesh whole = extract_mesh(gpu, volume, level);
        const Mesh bricked = extract_mesh(gpu, volume, level, {.max_brick_side = 27});
        EXPECT_EQ(whole.positions, bricked.positions) << name;
        EXPECT_EQ(whole.triangles, bricked.triangles) << name;
        EXPECT_EQ(whole.normals, bricked.normals) << name;
        Volume in_voxels = sampled(name);
        in_voxels.affine = {};
        expect_manifold(extract_mesh(gpu, in_voxels, level), in_voxels, name);
    }
}

TEST_F(GpuTest, SeveralMeshesAndNone) {
    const Volume volume = sampled("sphere:24");
    const auto meshes = extract_meshes(gpu, volume, {0.25, 9, 0.5});
    ASSERT_EQ(meshes.size(), 3u);
    EXPECT_TRUE(meshes[1].triangles.empty());
    EXPECT_GT(meshes[0].triangles.size(), meshes[2].triangles.size());
    for (const std::string thin : {"sphere:1x24x24", "sphere:24x1x24", "sphere:1"})
        EXPECT_TRUE(extract_mesh(gpu, sampled(thin), 0.25).positions.empty()) << thin;
    EXPECT_FALSE(extract_mesh(gpu, sampled("sphere:2x24x24"), 0.25).triangles.empty());
    EXPECT_THROW(extract_mesh(gpu, volume, std::nan("")), Error);
}

}  // namespace
