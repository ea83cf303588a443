// SPDX-License-Identifier: MIT
// The table of marching cubes (Lorensen & Cline 1987), generated: which triangles a cell holds for
// each of the 256 ways in which its corners can be inside or outside.
//
// Corner c = x + 2y + 4z of a cell; bit c of a case is set when the corner is inside (value >=
// isovalue). Edge e = 4 * axis + k, where k holds the two other coordinates of the edge in
// ascending axis order: an edge along y at x = 1, z = 0 is 4 * 1 + 1.
#pragma once
#include <array>
#include <cstdint>

namespace isorast {

struct CaseTable {
    // 64 bits for each case, low word first: bits 0..59 are edge numbers of 4 bits, three for each
    // triangle, counter-clockwise seen from outside; bits 60..63 are the number of triangles, 0
    // to 5.
    std::array<std::array<uint32_t, 2>, 256> packed;

    uint64_t bits(uint32_t cell_case) const {
        return packed[cell_case][0] | uint64_t{packed[cell_case][1]} << 32;
    }
    uint32_t triangle_count(uint32_t cell_case) const { return uint32_t(bits(cell_case) >> 60); }
    uint32_t edge(uint32_t cell_case, uint32_t index) const {
        return uint32_t(bits(cell_case) >> (4 * index)) & 15;
    }
};

// On a face with two inside corners across the diagonal, each is cut off for itself. That depends
// on the face alone, so neighbours agree and the surface has no hole.
CaseTable marching_cubes_table();

// The lower corner of an edge; the upper one is this | 1 << (edge / 4).
uint32_t lower_corner(uint32_t edge);

}  // namespace isorast
