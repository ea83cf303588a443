// SPDX-License-Identifier: MIT
// A meshlet, for C++ and GLSL.
#ifndef ISORAST_TECHNIQUES_MESHLETS_MESHLET_H
#define ISORAST_TECHNIQUES_MESHLETS_MESHLET_H
#include "shaders/shared.h"

#ifdef __cplusplus
namespace isorast::shared {
#endif

// Kubisch's limits, which Kreskowski 2022 (section 4) takes for its reference; 124 is the largest
// number of triangles up to 126 that meshoptimizer can lay out.
ISORAST_CONSTANT uint MESHLET_VERTICES = 64, MESHLET_TRIANGLES = 124;
// Meshlets that a task workgroup tests: a word of seen bits.
ISORAST_CONSTANT uint TASK_MESHLETS = 32;
ISORAST_CONSTANT uint ONLY_PASS = 0, FIRST_PASS = 1, SECOND_PASS = 2;

struct Meshlet {
    float low[3], high[3];  // its box, voxel space
    uint cone;  // around its normals, as meshoptimizer has it: axis and cutoff, signed bytes
    uint first_vertex, first_triangle;
    uint counts;  // vertices | triangles << 16
};

#ifdef __cplusplus
static_assert(sizeof(Meshlet) == 40);
}  // namespace isorast::shared
#endif
#endif
