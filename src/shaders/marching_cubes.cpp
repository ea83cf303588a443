// SPDX-License-Identifier: MIT
// Makes the table in three steps: segments on the six faces, closed loops of segments, triangles.
#include "shaders/marching_cubes.h"

#include <bit>
#include <cassert>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace isorast {

namespace {

constexpr int NONE = -1;
using Loop = std::vector<uint32_t>;  // edge numbers, counter-clockwise seen from outside

uint32_t edge_between(uint32_t corner, uint32_t neighbour) {
    uint32_t axis = uint32_t(std::countr_zero(corner ^ neighbour));
    uint32_t below = corner & ((1u << axis) - 1), above = corner >> (axis + 1);
    return 4 * axis + (below | above << axis);
}

// The corners of a face, counter-clockwise seen from outside the cell.
std::array<uint32_t, 4> face_corners(uint32_t axis, bool upper) {
    uint32_t u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3, base = upper ? 1u << axis : 0u;
    if (upper) return {base, base + u, base + u + v, base + v};
    return {base, base + v, base + u + v, base + u};
}

// Every run of inside corners around a face is cut off by one segment, from the edge where the walk
// enters to the edge where it leaves: the inside is on the segment's right, seen from outside the
// cell.
void add_segments(uint32_t cell_case, const std::array<uint32_t, 4>& corners,
                  std::array<int, 12>& next) {
    auto inside = [&](uint32_t step) { return (cell_case >> corners[step % 4] & 1) != 0; };
    for (uint32_t step = 0; step < 4; ++step) {
        if (inside(step) || !inside(step + 1)) continue;
        uint32_t last = step + 1;
        while (inside(last + 1))
            ++last;
        uint32_t enter = edge_between(corners[step], corners[(step + 1) % 4]);
        next[enter] = int(edge_between(corners[last % 4], corners[(last + 1) % 4]));
    }
}

// A crossed edge belongs to two faces that walk it in opposite directions: it ends one segment and
// starts one, so the segments close to loops.
std::vector<Loop> trace_loops(uint32_t cell_case) {
    std::array<int, 12> next;
    next.fill(NONE);
    for (uint32_t axis = 0; axis < 3; ++axis) {
        add_segments(cell_case, face_corners(axis, /* upper= */ false), next);
        add_segments(cell_case, face_corners(axis, /* upper= */ true), next);
    }
    std::vector<Loop> loops;
    for (uint32_t first = 0; first < 12; ++first) {
        if (next[first] == NONE) continue;
        Loop& loop = loops.emplace_back();
        for (uint32_t edge = first; next[edge] != NONE;) {
            loop.push_back(edge);
            edge = uint32_t(std::exchange(next[edge], NONE));
        }
    }
    return loops;
}

// Twice the middle of an edge.
std::array<int, 3> doubled_middle(uint32_t edge) {
    uint32_t corner = lower_corner(edge);
    std::array<int, 3> p{};
    for (uint32_t axis = 0; axis < 3; ++axis)
        p[axis] = int(corner >> axis & 1) * 2;
    p[edge / 4] = 1;
    return p;
}

// Short diagonals make good triangles. One in a face of the cell could coincide with one of the
// neighbour, an edge of four triangles: so it costs more than any sum of lengths.
int diagonal_cost(uint32_t a, uint32_t b) {
    auto p = doubled_middle(a), q = doubled_middle(b);
    int cost = 0;
    for (size_t axis = 0; axis < 3; ++axis) {
        cost += (p[axis] - q[axis]) * (p[axis] - q[axis]);
        if (p[axis] == q[axis] && p[axis] != 1) cost += 1000;
    }
    return cost;
}

// The cheapest triangulation of the part of the loop from `first` to `last`, which are joined by an
// edge or a diagonal: some triangle stands on that line, and splits the rest in two.
int triangulate(const Loop& loop, size_t first, size_t last, Loop& triangles) {
    if (last - first < 2) return 0;
    int best = std::numeric_limits<int>::max();
    Loop best_triangles;
    for (size_t tip = first + 1; tip < last; ++tip) {
        Loop candidate{loop[first], loop[tip], loop[last]};
        int cost =
            triangulate(loop, first, tip, candidate) + triangulate(loop, tip, last, candidate);
        if (tip - first > 1) cost += diagonal_cost(loop[first], loop[tip]);
        if (last - tip > 1) cost += diagonal_cost(loop[tip], loop[last]);
        if (cost >= best) continue;
        best = cost;
        best_triangles = std::move(candidate);
    }
    triangles.insert(triangles.end(), best_triangles.begin(), best_triangles.end());
    return best;
}

}  // namespace

uint32_t lower_corner(uint32_t edge) {
    uint32_t axis = edge / 4, k = edge % 4;
    return (k & ((1u << axis) - 1)) | k >> axis << (axis + 1);
}

CaseTable marching_cubes_table() {
    CaseTable table{};
    for (uint32_t cell_case = 0; cell_case < 256; ++cell_case) {
        Loop triangles;
        for (const Loop& loop : trace_loops(cell_case))
            triangulate(loop, 0, loop.size() - 1, triangles);
        assert(triangles.size() <= 15);
        uint64_t bits = uint64_t{triangles.size() / 3} << 60;
        for (size_t i = 0; i < triangles.size(); ++i)
            bits |= uint64_t{triangles[i]} << (4 * i);
        table.packed[cell_case] = {uint32_t(bits), uint32_t(bits >> 32)};
    }
    return table;
}

}  // namespace isorast
