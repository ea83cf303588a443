// A block as rows of sign bits, and the lists made of them: of some of its cell rows, the vertices
// and triangles. Needs triangle_table[] and MAX_TRIANGLES.
#include "shaders/cell_rows.glsl"

const uint ROWS = 81, CELL_ROWS = 64;  // of corners, of cells

shared uint signs[ROWS + 10];  // what lies beyond the last row is read, but does not count
shared uvec2 rows[ROWS];  // crossed edges of a corner row, in this slab, and the first one's number
shared uint triangles[MAX_TRIANGLES];  // cell | place in triangle_table << 12

// The corner rows of a cell row, which begins at this one.
CellRow cell_row(uint row) {
    return CellRow(signs[row], signs[row + 1], signs[row + 9], signs[row + 10]);
}

// Consecutive cell rows, y + 8 z.
struct Slab {
    uint first, count;
};

// Whether a cell row is in the slab, and in the volume.
bool in_slab(Slab slab, uint y, uint z, ivec3 left) {
    return y < 8 && z < 8 && int(y) < left.y && int(z) < left.z &&
           y + 8 * z - slab.first < slab.count;
}

// Corner rows around a slab: the first one's number, and what they end before.
uint first_corner_row(Slab slab) { return 9 * (slab.first / 8); }
uint end_corner_row(Slab slab) { return 9 * ((slab.first + slab.count + 7) / 8 + 1); }

// Crossed edges of a corner row that cells of the slab have.
uint crossed_edges(CellRow row, uint y, uint z, Slab slab, ivec3 left, uint cells_x) {
    // Cell rows around the corner row; y - 1 and z - 1 wrap to rows that are not there.
    const bool here = in_slab(slab, y, z, left), below = in_slab(slab, y - 1, z, left);
    const bool under = in_slab(slab, y, z - 1, left), both = in_slab(slab, y - 1, z - 1, left);
    const uint corners_x = cells_x << 1 | cells_x;
    return edge_bits(row.a, row.b, row.c) & ((here || below || under || both ? cells_x : 0) |
                                             (here || under ? corners_x << 8 : 0) |
                                             (here || below ? corners_x << 17 : 0));
}

// A cell: its corner row << 5 | x. Its first place in triangle_table.
uint table_entry(CellRow row, uint x) { return 5 * cell_case(row, x); }
uint triangle_count(uint entry) { return triangle_table[entry] >> 29; }

void list_triangles_of(uint cell, uint entry, uint count, uint first) {
    [[unroll]] for (uint number = 0; number < 5; ++number)
        if (number < count) triangles[first + number] = cell | entry + number << 12;
}

// A listed triangle: its cell, and where from there its corners are.
struct Listed {
    uint cell, corners;
};
Listed listed(uint i) {
    return Listed(triangles[i] & 0xfffu, triangle_table[triangles[i] >> 12]);
}

// The edge that a triangle's corner lies on: nine bits a corner, counted from the cell.
uint corner_edge(Listed triangle, uint corner) {
    return triangle.cell + (triangle.corners >> 9 * corner & 0x1ffu);
}

// The number of that vertex in the list.
uint corner_vertex(Listed triangle, uint corner) {
    const uint edge = corner_edge(triangle, corner);
    const uvec2 row = rows[edge >> 5];
    return row.y + bitCount(row.x & (1u << (edge & 31u)) - 1);
}
