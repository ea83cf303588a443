// Triangles of rows of cells (cell_rows.glsl). Needs cases[], the table of marching cubes.
#include "shaders/cell_rows.glsl"

uint triangle_count(uint cell_case_index) { return cases[cell_case_index].y >> 28; }

uint row_triangles(CellRow row, uint cells) {
    uint count = 0;
    for (uint left = occupied_cells(row) & cells; left != 0; left &= left - 1)
        count += triangle_count(cell_case(row, findLSB(left)));
    return count;
}

// The edge on which corner `i` of a case's triangle `number` lies.
uint triangle_edge(uvec2 case_entry, uint number, uint i) {
    const uint nibble = 3 * number + i;
    return (nibble < 8 ? case_entry.x >> 4 * nibble : case_entry.y >> 4 * (nibble - 8)) & 15u;
}
