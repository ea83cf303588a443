// SPDX-License-Identifier: MIT
// Meshlets of at most 64 vertices and 124 triangles (Kreskowski 2022, section 4, "Software"), tile
// by tile of the volume.
#include "techniques/meshlets/build.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <span>
#include <thread>
#include <unordered_map>

namespace isorast {

namespace {

// Blocks along a side of a tile: large enough that few meshlets end at a tile's border, small
// enough that a surface has many tiles for many threads.
constexpr uint32_t TILE_BLOCKS = 8;

// How much meshoptimizer prefers triangles that face alike to triangles that lie close: shapes
// alone count, as boxes and the frustum are what culls.
constexpr float CONE_WEIGHT = 0;

constexpr uint32_t MAX_TASK_GROUPS = 65535;  // along x, on every device

using shared::MESHLET_TRIANGLES;
using shared::MESHLET_VERTICES;

// The triangles of a tile, with vertices of its own.
struct Part {
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> indices;
};

Part gather(const Surface& surface, const std::vector<size_t>& blocks) {
    Part part;
    std::unordered_map<uint32_t, uint32_t> numbers;
    for (const size_t block : blocks) {
        const uint32_t end = surface.blocks[block + 1].first_triangle;
        for (uint32_t i = surface.blocks[block].first_triangle; i < end; ++i) {
            const glm::uvec3 triangle = surface.triangles[i];
            const auto at = [&](int corner) { return surface.positions[triangle[corner]]; };
            // Voxels at the isovalue make triangles without area: they cover no pixel.
            if (at(0) == at(1) || at(1) == at(2) || at(2) == at(0)) continue;
            for (int corner = 0; corner < 3; ++corner) {
                const auto [known, is_new] =
                    numbers.try_emplace(triangle[corner], uint32_t(part.positions.size()));
                if (is_new) part.positions.push_back(at(corner));
                part.indices.push_back(known->second);
            }
        }
    }
    return part;
}

void set_box(shared::Meshlet& meshlet, std::span<const glm::vec3> vertices) {
    glm::vec3 low = vertices[0], high = low;
    for (const glm::vec3& vertex : vertices) {
        low = glm::min(low, vertex);
        high = glm::max(high, vertex);
    }
    for (int axis = 0; axis < 3; ++axis) {
        meshlet.low[axis] = low[axis];
        meshlet.high[axis] = high[axis];
    }
}

uint32_t packed_cone(const meshopt_Bounds& bounds) {
    const auto byte = [](signed char value, int place) {
        return uint32_t(uint8_t(value)) << 8 * place;
    };
    return byte(bounds.cone_axis_s8[0], 0) | byte(bounds.cone_axis_s8[1], 1) |
           byte(bounds.cone_axis_s8[2], 2) | byte(bounds.cone_cutoff_s8, 3);
}

MeshletMesh build(const Part& part) {
    MeshletMesh mesh;
    if (part.indices.empty()) return mesh;
    const size_t bound =
        meshopt_buildMeshletsBound(part.indices.size(), MESHLET_VERTICES, MESHLET_TRIANGLES);
    std::vector<meshopt_Meshlet> found(bound);
    std::vector<unsigned> vertices(bound * MESHLET_VERTICES);
    std::vector<unsigned char> corners(bound * MESHLET_TRIANGLES * 3);
    found.resize(
        meshopt_buildMeshlets(found.data(), vertices.data(), corners.data(), part.indices.data(),
                              part.indices.size(), &part.positions[0].x, part.positions.size(),
                              sizeof(glm::vec3), MESHLET_VERTICES, MESHLET_TRIANGLES, CONE_WEIGHT));
    for (const meshopt_Meshlet& meshlet : found) {
        const size_t first = mesh.vertices.size();
        for (unsigned i = 0; i < meshlet.vertex_count; ++i)
            mesh.vertices.push_back(part.positions[vertices[meshlet.vertex_offset + i]]);
        shared::Meshlet out{};
        set_box(out, std::span(mesh.vertices).subspan(first));
        out.cone = packed_cone(meshopt_computeMeshletBounds(
            &vertices[meshlet.vertex_offset], &corners[meshlet.triangle_offset],
            meshlet.triangle_count, &part.positions[0].x, part.positions.size(),
            sizeof(glm::vec3)));
        out.first_vertex = uint32_t(first);
        out.first_triangle = uint32_t(mesh.triangles.size());
        out.counts = meshlet.vertex_count | meshlet.triangle_count << 16;
        for (unsigned i = 0; i < meshlet.triangle_count; ++i) {
            const unsigned char* c = &corners[meshlet.triangle_offset + size_t{3} * i];
            mesh.triangles.push_back(uint32_t(c[0] | c[1] << 8 | c[2] << 16));
        }
        mesh.meshlets.push_back(out);
    }
    return mesh;
}

// The places in Surface::blocks of each tile's blocks.
std::vector<std::vector<size_t>> share_out(const Surface& surface, glm::uvec3 blocks_along) {
    const glm::uvec3 tiles = (blocks_along + TILE_BLOCKS - 1u) / TILE_BLOCKS;
    std::vector<std::vector<size_t>> shares(size_t{tiles.x} * tiles.y * tiles.z);
    for (size_t i = 0; i + 1 < surface.blocks.size(); ++i) {
        const uint32_t block = surface.blocks[i].block;
        const glm::uvec3 tile =
            glm::uvec3(block % blocks_along.x, block / blocks_along.x % blocks_along.y,
                       block / (blocks_along.x * blocks_along.y)) /
            TILE_BLOCKS;
        shares[tile.x + tiles.x * (tile.y + size_t{tiles.y} * tile.z)].push_back(i);
    }
    return shares;
}

bool fits(const MeshletMesh& a, const MeshletMesh& b, uint64_t most_bytes) {
    const size_t meshlets = a.meshlets.size() + b.meshlets.size();
    return meshlets <= size_t{MAX_TASK_GROUPS} * shared::TASK_MESHLETS &&
           std::max({meshlets * sizeof(shared::Meshlet),
                     (a.vertices.size() + b.vertices.size()) * sizeof(glm::vec3),
                     (a.triangles.size() + b.triangles.size()) * sizeof(uint32_t)}) <= most_bytes;
}

void append(MeshletMesh& to, const MeshletMesh& from) {
    for (shared::Meshlet meshlet : from.meshlets) {
        meshlet.first_vertex += uint32_t(to.vertices.size());
        meshlet.first_triangle += uint32_t(to.triangles.size());
        to.meshlets.push_back(meshlet);
    }
    to.vertices.insert(to.vertices.end(), from.vertices.begin(), from.vertices.end());
    to.triangles.insert(to.triangles.end(), from.triangles.begin(), from.triangles.end());
}

}  // namespace

std::vector<MeshletMesh> build_meshlets(const Surface& surface, glm::uvec3 blocks_along,
                                        uint64_t most_bytes) {
    const auto shares = share_out(surface, blocks_along);
    std::vector<MeshletMesh> tiles(shares.size());
    std::atomic<size_t> next = 0;
    const auto work = [&] {
        for (size_t tile; (tile = next++) < shares.size();)
            tiles[tile] = build(gather(surface, shares[tile]));
    };
    std::vector<std::future<void>> workers;
    for (unsigned i = 0; i < std::max(std::thread::hardware_concurrency(), 1u); ++i)
        workers.push_back(std::async(std::launch::async, work));
    for (auto& worker : workers)
        worker.get();

    std::vector<MeshletMesh> meshes;
    for (MeshletMesh& tile : tiles) {
        if (tile.meshlets.empty()) continue;
        if (meshes.empty() || !fits(meshes.back(), tile, most_bytes)) meshes.emplace_back();
        append(meshes.back(), tile);
        tile = {};
    }
    return meshes;
}

}  // namespace isorast
