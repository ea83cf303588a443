#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Workgroup: one block. Thread: its corner rows, then its cell rows. Out: how many vertices
// (crossed edges that it owns) and triangles the block has, as vertices | triangles << 16.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"

layout(local_size_x = 64) in;

layout(set = 1, binding = 0, std430) readonly buffer Cases { uvec2 cases[]; };
layout(set = 1, binding = 1, std430) writeonly buffer Counts { uint counts[]; };
layout(push_constant) uniform Push {
    float iso;
    uint first_block, block_count, workgroups_in_row;
};

#include "passes/surface_block.glsl"

shared uint total;

void main() {
    const uint index = gl_WorkGroupID.x + workgroups_in_row * gl_WorkGroupID.y;
    if (index >= block_count) return;
    const uint block = first_block + index, thread = gl_LocalInvocationIndex;
    const uvec3 first = first_cell_of(block);
    const ivec3 left = cells_left(first);
    // A volume one voxel thin has crossed edges, but no cells.
    if (any(lessThan(left, ivec3(1))) || !crosses(node_range(block), iso)) {
        if (thread == 0) counts[index] = 0;
        return;
    }
    if (thread == 0) total = 0;
    load_block(first, iso);
    uint vertices = 0;
    for (uint row = thread; row < CORNER_ROWS; row += THREADS)
        vertices += bitCount(owned_edges(row, left));
    const uint y = thread & 7u, z = thread >> 3;
    const uint triangles = row_triangles(cell_row_of(y, z), existing_cells(y, z, left));
    atomicAdd(total, vertices | triangles << 16);
    barrier();
    if (thread == 0) counts[index] = total;
}
