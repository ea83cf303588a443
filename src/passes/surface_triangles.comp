#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Workgroup: one block. Thread: a row of cells. Out: the block's triangles, as three vertex numbers
// each, counter-clockwise seen from outside (in voxel space).
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"

layout(local_size_x = 64) in;

layout(set = 1, binding = 0, std430) readonly buffer Cases { uvec2 cases[]; };
layout(set = 1, binding = 1, std430) readonly buffer Blocks { uvec4 blocks[]; };
layout(set = 1, binding = 2, std430) readonly buffer RowVertices { uint16_t row_vertices[]; };
layout(set = 1, binding = 3, std430) readonly buffer Slots { uint slots[]; };  // block to slot
layout(set = 1, binding = 4, std430) writeonly buffer Triangles { uint triangles[]; };
layout(push_constant) uniform Push {
    float iso;
    uint block_count, workgroups_in_row;
    uint first_block;     // the block at slots[0]
    uint first_triangle;  // the number of the triangle at triangles[0]
};

#include "passes/surface_block.glsl"

const uint NO_SLOT = ~0u;

// Numbers of the first vertex on edges along each axis in each corner row: from this block's side,
// and of the corner x = 8, which the next block along x may own.
shared uint row_first[3 * CORNER_ROWS], row_last[3 * CORNER_ROWS];
shared uint triangle_counts[THREADS];

// The number of the first vertex of a corner row and axis, in the block that owns the row.
uint first_of_row(uint block, uint row, uint axis, bvec3 beyond) {
    const uvec3 over = uvec3(beyond);
    const uint owner = block + over.x + grid.blocks.x * (over.y + grid.blocks.y * over.z);
    const uint slot = slots[owner - first_block];
    if (slot == NO_SLOT) return 0;  // no edge there is crossed
    const uint y = row % 9 - 8 * over.y, z = row / 9 - 8 * over.z;
    const uint entry = 3 * (CORNER_ROWS * slot + corner_row(y, z)) + axis;
    return blocks[slot].y + uint(row_vertices[entry]);
}

uint vertex_on(uint edge, bool next_owns_last) {
    const uint row = edge >> 5, bit = edge & 31u, axis = edge_axis(edge);
    if (edge_corner(edge).x == 8 && next_owns_last) return row_last[3 * row + axis];
    const uint before = crossed_edges(row) & ((1u << bit) - 1);
    const uint same_axis = axis == 0 ? EDGES_X : axis == 1 ? EDGES_Y : EDGES_Z;
    return row_first[3 * row + axis] + bitCount(before & same_axis);
}

void write_triangle(uint index, uvec2 entry, uint number, uvec3 cell, bool next_owns_last) {
    for (uint i = 0; i < 3; ++i) {
        const uint edge = edge_of_cell(triangle_edge(entry, number, i), cell.x, cell.y, cell.z);
        triangles[3 * index + i] = vertex_on(edge, next_owns_last);
    }
}

void main() {
    const uint slot = gl_WorkGroupID.x + workgroups_in_row * gl_WorkGroupID.y;
    if (slot >= block_count) return;
    const uint thread = gl_LocalInvocationIndex, block = blocks[slot].x;
    const uvec3 first = first_cell_of(block);
    const ivec3 left = cells_left(first);
    const bvec3 has_next = greaterThan(left, ivec3(8));
    load_block(first, iso);
    for (uint i = thread; i < 3 * CORNER_ROWS; i += THREADS) {
        const uint row = i / 3, axis = i % 3;
        const bool over_y = row % 9 == 8 && has_next.y, over_z = row / 9 == 8 && has_next.z;
        row_first[i] = first_of_row(block, row, axis, bvec3(false, over_y, over_z));
        if (has_next.x) row_last[i] = first_of_row(block, row, axis, bvec3(true, over_y, over_z));
    }
    const uint y = thread & 7u, z = thread >> 3;
    const CellRow row = cell_row_of(y, z);
    const uint cells = existing_cells(y, z, left);
    triangle_counts[thread] = row_triangles(row, cells);
    barrier();

    uint index = blocks[slot].z - first_triangle;
    for (uint i = 0; i < thread; ++i) index += triangle_counts[i];
    for (uint bits = occupied_cells(row) & cells; bits != 0; bits &= bits - 1) {
        const uint x = findLSB(bits);
        const uvec2 entry = cases[cell_case(row, x)];
        for (uint number = 0; number < entry.y >> 28; ++number)
            write_triangle(index++, entry, number, uvec3(x, y, z), has_next.x);
    }
}
