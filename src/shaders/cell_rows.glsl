// Rows of corners and of cells along x, seen as bits: one bit a corner says "inside"; what follows
// from it, edges and cells that the surface crosses, follows for a whole row at a time. Needs
// shaders/volume.glsl.

// Corner rows have 9 corners, cell rows 8 cells; a block has 9 corner rows along y.
uint corner_row(uint y, uint z) { return y + 9 * z; }

// The cells that exist: blocks at the volume's end may be cut short.
ivec3 cells_left(uvec3 first_cell) { return ivec3(grid.voxels.xyz) - 1 - ivec3(first_cell); }

// Fetches that are on their way at once: 3 or 9. More wait less, and take registers, of which a GPU
// has so many for all workgroups.
#ifndef SIGNS_AT_ONCE
#define SIGNS_AT_ONCE 9
#endif

// The signs of a row of texels: of nine, or the last one's again beyond `last`.
uint signs_of_texels(uint brick, ivec3 first, bool nine, int last, float threshold) {
    uint bits = 0;
    [[dont_unroll]] for (int x = 0; x < 9; x += SIGNS_AT_ONCE) {
        float texels[SIGNS_AT_ONCE];
        [[unroll]] for (int i = 0; i < SIGNS_AT_ONCE; ++i)
            texels[i] = fetch_texel(brick, first + ivec3(nine ? x + i : min(x + i, last), 0, 0));
        [[unroll]] for (int i = 0; i < SIGNS_AT_ONCE; ++i)
            bits |= (texels[i] >= threshold ? 1u : 0u) << x + i;
    }
    return bits;
}

// The signs of a block's corner row that begins at a voxel. Voxels may lie outside the volume:
// their signs are any.
uint load_signs(Brick brick, ivec3 start, float iso) {
#ifndef BRICKED
    if (VOXEL_FORMAT >= VOXELS_IN_BUFFER) {
        const uint values = 32 / VOXEL_BITS;
        const uint first = voxel_index(uvec3(clamp_to_volume(start))) / values;
        uint bits = 0;
        for (uint x = 0; x < 9; x += values) {
            const uint word = voxels[min(first + x / values, voxels.length() - 1)];
            for (uint i = 0; i < values; ++i)
                bits |= (value_in(word, i) >= iso ? 1u : 0u) << x + i;
        }
        return bits & 0x1ffu;
    }
#endif
    const float threshold = texel_threshold(iso);
    if (all(lessThan(start + ivec3(8, 0, 0), ivec3(grid.voxels.xyz))))
        return signs_of_texels(brick.index, start - brick.origin, true, 8, threshold);
    const ivec3 row = clamp_to_volume(start);
    return signs_of_texels(brick.index, row - brick.origin, false,
                           int(grid.voxels.x) - 1 - row.x, threshold);
}

// Edges that the surface crosses whose lower corner is in this corner row: bits 0..7 along x, 8..16
// along y, 17..25 along z.
uint edge_bits(uint row, uint row_y, uint row_z) {
    return ((row ^ row >> 1) & 0xffu) | (row ^ row_y) << 8 | (row ^ row_z) << 17;
}
const uint EDGES_X = 0xffu, EDGES_Y = 0x1ffu << 8, EDGES_Z = 0x1ffu << 17;

// An edge: its corner row << 5 | its bit there.
uint edge_axis(uint edge) {
    const uint bit = edge & 31u;
    return bit < 8 ? 0 : bit < 17 ? 1 : 2;
}
uvec3 edge_corner(uint edge) {
    const uint bit = edge & 31u, row = edge >> 5, axis = edge_axis(edge);
    return uvec3(bit - (axis == 0 ? 0 : axis == 1 ? 8 : 17), row % 9, row / 9);
}

// Where the surface crosses an edge, in voxel space. Always computed from the lower corner to the
// upper one, from the same two voxels: cells, blocks, bricks and rasterizers that share the edge
// get the same bits, so the surface is watertight.
vec3 crossing(uvec3 corner, uint axis, float lower, float upper, float iso) {
    precise const float t = (iso - lower) / (upper - lower);
    precise vec3 position = vec3(corner);
    position[axis] += t;
    return position;
}

// The values at an edge's lower and upper corner.
vec2 edge_values(Brick brick, ivec3 corner, uint axis) {
    ivec3 step = ivec3(0);
    step[axis] = 1;
    return vec2(voxel(brick, corner), voxel(brick, corner + step));
}

// The edge `number` (marching_cubes.h) of cell (x, y, z).
uint edge_of_cell(uint number, uint x, uint y, uint z) {
    const uint axis = number >> 2, low = number & 1u, high = number >> 1 & 1u;
    if (axis == 0) return corner_row(y + low, z + high) << 5 | x;
    if (axis == 1) return corner_row(y, z + high) << 5 | (8 + x + low);
    return corner_row(y + high, z) << 5 | (17 + x + low);
}

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
