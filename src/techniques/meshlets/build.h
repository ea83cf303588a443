// SPDX-License-Identifier: MIT
// From a surface to meshlets, by meshoptimizer.
#pragma once
#include "passes/surface.h"
#include "techniques/meshlets/meshlet.h"

namespace isorast {

struct MeshletMesh {
    std::vector<shared::Meshlet> meshlets;
    std::vector<glm::vec3>
        vertices;  // those of a meshlet side by side, repeated in each that has them
    std::vector<uint32_t> triangles;  // corners in the meshlet: a | b << 8 | c << 16

    uint64_t bytes() const {
        return meshlets.size() * sizeof(shared::Meshlet) + vertices.size() * sizeof(glm::vec3) +
               triangles.size() * sizeof(uint32_t);
    }
};

// Built tile by tile of the volume, in parallel, and gathered into meshes none of whose arrays has
// more than `most_bytes` (at least 32 MiB). `blocks_along`: the grid's.
std::vector<MeshletMesh> build_meshlets(const Surface& surface, glm::uvec3 blocks_along,
                                        uint64_t most_bytes);

}  // namespace isorast
