// Half of a block, 8x8x4 cells (the paper's block, section 3.2), seen as bits. Its 9x9x5 corners
// are 45 corner rows of 9 along x; its cells are 32 cell rows of 8. One bit a corner says "inside";
// what follows from it, edges and cells that the surface crosses, follows for a whole row at a
// time.

const uint CORNER_ROWS = 45, CELL_ROWS = 32, SIGN_WORDS = 15;

// From the task shader to its mesh shaders: 80 bytes, where the paper's interface block takes 324.
struct Payload {
    uint first_cell[3];      // the half block's lowest corner
    uint row_starts;         // bit r: a mesh workgroup begins at cell row r
    uint row_splits;         // bit r: row r alone has two workgroups, for x < 4 and x >= 4
    uint signs[SIGN_WORDS];  // three corner rows of 9 bits a word
};

uint corner_row(uint y, uint z) { return y + 9 * z; }

// The cells that exist: blocks at the volume's end may be cut short.
ivec3 cells_left(uvec3 first_cell) { return ivec3(grid.voxels.xyz) - 1 - ivec3(first_cell); }

// Edges that the surface crosses whose lower corner is in this corner row: bits 0..7 along x, 8..16
// along y, 17..25 along z.
uint edge_bits(uint row, uint row_y, uint row_z) {
    return ((row ^ row >> 1) & 0xffu) | (row ^ row_y) << 8 | (row ^ row_z) << 17;
}
const uint EDGES_X = 0xffu, EDGES_Y = 0x1ffu << 8, EDGES_Z = 0x1ffu << 17;

// Corner rows of a cell row: a, b at y and y + 1; c, d the same at z + 1.
struct CellRow {
    uint a, b, c, d;
};

// Bit x: the surface crosses cell x.
uint occupied_cells(CellRow row) {
    const uint any_inside = row.a | row.b | row.c | row.d;
    const uint all_inside = row.a & row.b & row.c & row.d;
    return (any_inside | any_inside >> 1) & ~(all_inside & all_inside >> 1) & 0xffu;
}

// The marching-cubes case of cell x: bit c for corner c = x + 2y + 4z.
uint cell_case(CellRow row, uint x) {
    const uvec4 pairs = uvec4(row.a, row.b, row.c, row.d) >> x & 3u;
    return pairs.x | pairs.y << 2 | pairs.z << 4 | pairs.w << 6;
}

uint triangle_count(uint cell_case_index) { return cases[cell_case_index].y >> 28; }

uint row_triangles(CellRow row, uint cells) {
    uint count = 0;
    for (uint left = occupied_cells(row) & cells; left != 0; left &= left - 1)
        count += triangle_count(cell_case(row, findLSB(left)));
    return count;
}
