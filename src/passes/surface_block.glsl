// One block in the passes that extract a surface: the signs of its 9x9x9 corners as 81 corner rows,
// and the edges that belong to it. An edge belongs to the block that its lower corner lies in; the
// last block along an axis also owns the volume's border plane. So each edge has one owner.
#include "shaders/cases.glsl"

const uint CORNER_ROWS = 81, THREADS = 64;

shared uint signs[CORNER_ROWS];

uvec3 first_cell_of(uint block) {
    const uvec3 blocks = grid.blocks.xyz;
    return uvec3(block % blocks.x, block / blocks.x % blocks.y, block / (blocks.x * blocks.y)) *
           BLOCK;
}

// All threads together.
void load_block(uvec3 first, float iso) {
    const Brick brick = brick_of(ivec3(first));
    for (uint row = gl_LocalInvocationIndex; row < CORNER_ROWS; row += THREADS)
        signs[row] = load_signs(brick, ivec3(first) + ivec3(0, row % 9, row / 9), iso);
    barrier();
}

// Crossed edges whose lower corner lies in this corner row, of whatever block.
uint crossed_edges(uint row) {
    return edge_bits(signs[row], signs[min(row + 1, CORNER_ROWS - 1)],
                     signs[min(row + 9, CORNER_ROWS - 1)]);
}

// Those that are the block's own. `left`: cells_left().
uint owned_edges(uint row, ivec3 left) {
    const int y = int(row % 9), z = int(row / 9);
    const ivec3 corners = mix(ivec3(8), left + 1, lessThanEqual(left, ivec3(8)));
    if (y >= corners.y || z >= corners.z) return 0;
    const uint cells_x = (1u << min(left.x, 8)) - 1, corners_x = (1u << corners.x) - 1;
    const uint exist = cells_x | (y < min(left.y, 8) ? corners_x << 8 : 0) |
                       (z < min(left.z, 8) ? corners_x << 17 : 0);
    return crossed_edges(row) & exist;
}

// The cells of a cell row that exist.
uint existing_cells(uint y, uint z, ivec3 left) {
    return int(y) < left.y && int(z) < left.z ? (1u << min(left.x, 8)) - 1 : 0;
}

CellRow cell_row_of(uint y, uint z) {
    return CellRow(signs[corner_row(y, z)], signs[corner_row(y + 1, z)],
                   signs[corner_row(y, z + 1)], signs[corner_row(y + 1, z + 1)]);
}
