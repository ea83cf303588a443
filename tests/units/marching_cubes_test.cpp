// SPDX-License-Identifier: MIT
// The table leaves no hole: over all cases, over all pairs of neighbouring cells, and over random
// fields.
#include "shaders/marching_cubes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace {

using isorast::CaseTable;
using isorast::lower_corner;
using Segment = std::pair<uint32_t, uint32_t>;  // from one edge's crossing to another's
using Point = std::array<double, 3>;

const CaseTable table = isorast::marching_cubes_table();

uint32_t upper_corner(uint32_t edge) {
    return lower_corner(edge) | 1u << (edge / 4);
}

bool inside(uint32_t cell_case, uint32_t corner) {
    return (cell_case >> corner & 1) != 0;
}

bool crossed(uint32_t cell_case, uint32_t edge) {
    return inside(cell_case, lower_corner(edge)) != inside(cell_case, upper_corner(edge));
}

bool on_face(uint32_t edge, uint32_t axis, bool upper) {
    return edge / 4 != axis && (lower_corner(edge) >> axis & 1) == uint32_t(upper);
}

bool share_a_face(Segment segment) {
    for (uint32_t axis = 0; axis < 3; ++axis)
        for (bool upper : {false, true})
            if (on_face(segment.first, axis, upper) && on_face(segment.second, axis, upper))
                return true;
    return false;
}

Segment reversed(Segment segment) {
    return {segment.second, segment.first};
}

// Every side of every triangle of a case, with how often it occurs.
std::map<Segment, int> sides(uint32_t cell_case) {
    std::map<Segment, int> result;
    for (uint32_t t = 0; t < table.triangle_count(cell_case); ++t)
        for (uint32_t i = 0; i < 3; ++i)
            ++result[{table.edge(cell_case, 3 * t + i),
                      table.edge(cell_case, 3 * t + (i + 1) % 3)}];
    return result;
}

// The sides on one face, with the edges numbered as in the lower face.
std::set<Segment> face_segments(uint32_t cell_case, uint32_t axis, bool upper) {
    auto lowered = [&](uint32_t edge) {
        for (uint32_t e = 0; e < 12; ++e)
            if (e / 4 == edge / 4 && lower_corner(e) == (lower_corner(edge) & ~(1u << axis)))
                return e;
        return edge;
    };
    std::set<Segment> result;
    for (auto [side, count] : sides(cell_case))
        if (on_face(side.first, axis, upper) && on_face(side.second, axis, upper))
            result.insert({lowered(side.first), lowered(side.second)});
    return result;
}

Point middle(uint32_t edge) {
    Point p{};
    for (uint32_t axis = 0; axis < 3; ++axis)
        p[axis] = axis == edge / 4 ? 0.5 : (lower_corner(edge) >> axis & 1);
    return p;
}

Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

TEST(MarchingCubes, EdgesAreNumberedAsDocumented) {
    EXPECT_EQ(lower_corner(4 * 0 + 3), 2u + 4u);  // along x at y = 1, z = 1
    EXPECT_EQ(lower_corner(4 * 1 + 1), 1u);       // along y at x = 1, z = 0
    EXPECT_EQ(lower_corner(4 * 1 + 2), 4u);       // along y at x = 0, z = 1
    EXPECT_EQ(lower_corner(4 * 2 + 2), 2u);       // along z at x = 0, y = 1
}

TEST(MarchingCubes, UsesTheCrossedEdgesAndNoOther) {
    for (uint32_t cell_case = 0; cell_case < 256; ++cell_case) {
        std::set<uint32_t> used, expected;
        ASSERT_LE(table.triangle_count(cell_case), 5u);
        for (uint32_t i = 0; i < 3 * table.triangle_count(cell_case); ++i)
            used.insert(table.edge(cell_case, i));
        for (uint32_t edge = 0; edge < 12; ++edge)
            if (crossed(cell_case, edge)) expected.insert(edge);
        EXPECT_EQ(used, expected) << "case " << cell_case;
    }
}

TEST(MarchingCubes, SidesMeetInTheCellOrLieOnAFace) {
    for (uint32_t cell_case = 0; cell_case < 256; ++cell_case) {
        auto all = sides(cell_case);
        for (auto [side, count] : all) {
            EXPECT_EQ(count, 1) << "case " << cell_case;
            EXPECT_NE(all.contains(reversed(side)), share_a_face(side))
                << "case " << cell_case << " edges " << side.first << ' ' << side.second;
        }
    }
}

TEST(MarchingCubes, NeighboursAgreeOnEveryFace) {
    for (uint32_t axis = 0; axis < 3; ++axis) {
        std::array<std::set<Segment>, 256> upper, lower;
        for (uint32_t cell_case = 0; cell_case < 256; ++cell_case) {
            upper[cell_case] = face_segments(cell_case, axis, true);
            for (Segment s : face_segments(cell_case, axis, false))
                lower[cell_case].insert(reversed(s));
        }
        for (uint32_t a = 0; a < 256; ++a) {
            for (uint32_t b = 0; b < 256; ++b) {
                bool compatible = true;
                for (uint32_t corner = 0; corner < 8; ++corner)
                    if ((corner >> axis & 1) == 0)
                        compatible =
                            compatible && inside(a, corner | 1u << axis) == inside(b, corner);
                if (!compatible) continue;
                ASSERT_EQ(upper[a], lower[b]) << "axis " << axis << ' ' << a << ' ' << b;
            }
        }
    }
}

TEST(MarchingCubes, TrianglesFaceTheOutside) {
    for (uint32_t cell_case = 1; cell_case < 255; ++cell_case) {
        Point outwards{}, area{};
        for (uint32_t corner = 0; corner < 8; ++corner)
            for (uint32_t axis = 0; axis < 3; ++axis)
                outwards[axis] +=
                    (inside(cell_case, corner) ? -1 : 1) * ((corner >> axis & 1) - 0.5);
        for (uint32_t t = 0; t < table.triangle_count(cell_case); ++t) {
            Point p = middle(table.edge(cell_case, 3 * t)),
                  q = middle(table.edge(cell_case, 3 * t + 1)),
                  r = middle(table.edge(cell_case, 3 * t + 2));
            for (size_t axis = 0; axis < 3; ++axis) {
                q[axis] -= p[axis];
                r[axis] -= p[axis];
            }
            for (size_t axis = 0; axis < 3; ++axis)
                area[axis] += cross(q, r)[axis];
        }
        if (dot(outwards, outwards) == 0) continue;
        EXPECT_GT(dot(area, outwards), 0) << "case " << cell_case;
    }
}

// Marching cubes on a field of SIDE^3 values; a vertex is known by the edge of the grid that it
// lies on.
struct Mesh {
    static constexpr uint32_t SIDE = 12;
    std::map<std::pair<uint64_t, uint64_t>, int> sides;
    double volume = 0;

    static uint32_t index(uint32_t x, uint32_t y, uint32_t z) { return (z * SIDE + y) * SIDE + x; }

    Mesh(const std::vector<uint8_t>& field, double isovalue) {
        for (uint32_t z = 0; z + 1 < SIDE; ++z)
            for (uint32_t y = 0; y + 1 < SIDE; ++y)
                for (uint32_t x = 0; x + 1 < SIDE; ++x)
                    add_cell(field, isovalue, x, y, z);
    }

    void add_cell(const std::vector<uint8_t>& field, double isovalue, uint32_t x, uint32_t y,
                  uint32_t z) {
        auto at = [&](uint32_t c) { return index(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)); };
        uint32_t cell_case = 0;
        for (uint32_t corner = 0; corner < 8; ++corner)
            cell_case |= uint32_t(field[at(corner)] >= isovalue) << corner;
        for (uint32_t t = 0; t < table.triangle_count(cell_case); ++t) {
            std::array<uint64_t, 3> id;
            std::array<Point, 3> p;
            for (uint32_t i = 0; i < 3; ++i) {
                uint32_t edge = table.edge(cell_case, 3 * t + i), low = lower_corner(edge);
                double a = field[at(low)], b = field[at(upper_corner(edge))];
                id[i] = uint64_t{at(low)} * 3 + edge / 4;
                p[i] = {double(x + (low & 1)), double(y + (low >> 1 & 1)), double(z + (low >> 2))};
                p[i][edge / 4] += (isovalue - a) / (b - a);
            }
            for (size_t i = 0; i < 3; ++i)
                ++sides[{id[i], id[(i + 1) % 3]}];
            volume += dot(p[0], cross(p[1], p[2])) / 6;
        }
    }
};

TEST(MarchingCubes, RandomFieldsWithValuesAtTheIsovalueAreClosed) {
    std::mt19937 random(7);
    const std::array<uint8_t, 6> values{0, 99, 100, 100, 101, 255};
    for (int round = 0; round < 60; ++round) {
        std::vector<uint8_t> field(Mesh::SIDE * Mesh::SIDE * Mesh::SIDE, 0);
        for (uint32_t z = 1; z + 1 < Mesh::SIDE; ++z)
            for (uint32_t y = 1; y + 1 < Mesh::SIDE; ++y)
                for (uint32_t x = 1; x + 1 < Mesh::SIDE; ++x)
                    field[Mesh::index(x, y, z)] = values[random() % values.size()];
        Mesh mesh(field, /* isovalue= */ 100);
        ASSERT_GT(mesh.sides.size(), 1000u);
        for (auto [side, count] : mesh.sides) {
            ASSERT_EQ(count, 1);
            ASSERT_TRUE(mesh.sides.contains({side.second, side.first}));
        }
        EXPECT_GT(mesh.volume, 0);
    }
}

TEST(MarchingCubes, OneVoxelInsideMakesAnOctahedron) {
    std::vector<uint8_t> field(Mesh::SIDE * Mesh::SIDE * Mesh::SIDE, 0);
    field[Mesh::index(5, 6, 4)] = 200;
    Mesh mesh(field, /* isovalue= */ 100);
    EXPECT_EQ(mesh.sides.size(), 24u);
    EXPECT_NEAR(mesh.volume, 1.0 / 6, 1e-12);
}

}  // namespace
