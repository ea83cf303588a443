// SPDX-License-Identifier: MIT
// Vertices that coincide become one.
#pragma once
#include "passes/surface.h"

namespace isorast {

// Voxels at the isovalue put the vertices of all their crossed edges into one place, and triangles
// without area between them. Joins such vertices and drops such triangles wherever the surface
// stays a manifold (every edge keeps two triangles, or one at the border); where it would not, as
// where two sheets touch, moves the vertices apart, a thousandth of a voxel along their edges.
// Drops parts that are only points and lines. Needs gradients; clears Surface::blocks.
void weld(Surface& surface, glm::uvec3 voxels);

}  // namespace isorast
