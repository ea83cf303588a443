#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Workgroup: one block that has vertices or triangles. Thread: its corner rows. Out: a vertex for
// each crossed edge that the block owns, and for each corner row and axis the number of the first
// such vertex in the block, from which blocks below find the vertices that they share.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"

layout(local_size_x = 64) in;

layout(constant_id = 1) const bool GRADIENTS = false;

layout(set = 1, binding = 0, std430) readonly buffer Cases { uvec2 cases[]; };
layout(set = 1, binding = 1, std430) readonly buffer Blocks { uvec4 blocks[]; };
layout(set = 1, binding = 2, std430) writeonly buffer RowVertices { uint16_t row_vertices[]; };
layout(set = 1, binding = 3, std430) writeonly buffer Positions { float positions[]; };
layout(set = 1, binding = 4, std430) writeonly buffer Gradients { vec4 gradients[]; };
layout(push_constant) uniform Push {
    float iso;
    uint block_count, workgroups_in_row;
    uint own_blocks;    // the first so many have their vertices written; the others only counted
    uint first_vertex;  // the number of the vertex at positions[0]
};

#include "passes/surface_block.glsl"

shared uint vertex_counts[CORNER_ROWS];

void write_vertex(uint index, uvec3 first, uint edge, Brick brick) {
    const uint axis = edge_axis(edge);
    const ivec3 corner = ivec3(first + edge_corner(edge));
    const vec2 ends = edge_values(brick, corner, axis);
    const vec3 p = crossing(uvec3(corner), axis, ends.x, ends.y, iso);
    for (uint i = 0; i < 3; ++i) positions[3 * index + i] = p[i];
    if (!GRADIENTS) return;
    // The edge, seen from the lower corner if the vertex lies there, else from the upper one.
    const float away = p[axis] == float(corner[axis]) ? 0.0 : 3.0;
    gradients[index] = vec4(field_gradient(p), float(axis) + away);
}

void main() {
    const uint slot = gl_WorkGroupID.x + workgroups_in_row * gl_WorkGroupID.y;
    if (slot >= block_count) return;
    const uint thread = gl_LocalInvocationIndex;
    const uvec3 first = first_cell_of(blocks[slot].x);
    const ivec3 left = cells_left(first);
    load_block(first, iso);
    for (uint row = thread; row < CORNER_ROWS; row += THREADS)
        vertex_counts[row] = bitCount(owned_edges(row, left));
    barrier();
    const Brick brick = brick_of(ivec3(first));
    for (uint row = thread; row < CORNER_ROWS; row += THREADS) {
        uint before = 0;
        for (uint i = 0; i < row; ++i) before += vertex_counts[i];
        const uint edges = owned_edges(row, left), entry = 3 * (CORNER_ROWS * slot + row);
        row_vertices[entry] = uint16_t(before);
        row_vertices[entry + 1] = uint16_t(before + bitCount(edges & EDGES_X));
        row_vertices[entry + 2] = uint16_t(before + bitCount(edges & (EDGES_X | EDGES_Y)));
        if (slot >= own_blocks) continue;
        uint index = blocks[slot].y - first_vertex + before;
        for (uint bits = edges; bits != 0; bits &= bits - 1)
            write_vertex(index++, first, row << 5 | findLSB(bits), brick);
    }
}
