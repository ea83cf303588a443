#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: one active group at a time. Thread: one block. Out: the list of active blocks in the
// frustum, in chunks, and the task shader's indirect arguments.
#include "shaders/scene.glsl"
#include "techniques/direct/list.glsl"

layout(local_size_x = 32) in;

layout(constant_id = 1) const bool CULLING = true;

layout(set = 1, binding = 0, std430) readonly buffer ActiveGroups {
    uint dispatch_x, dispatch_y, dispatch_z;
    uint group_count;
    uvec2 active_groups[];
};
struct DrawArguments {
    uint blocks, halves, one;  // VkDrawMeshTasksIndirectCommandEXT
};
layout(set = 1, binding = 1, std430) buffer Draws { DrawArguments draws[]; };
layout(set = 1, binding = 2, std430) writeonly buffer DrawnBlocks { uint16_t drawn_blocks[]; };
layout(set = 1, binding = 3, std430) buffer CounterBlock { Counters counters; };

shared uint drawn_mask;
shared uint first_entry;

// True unless the whole block lies outside one plane of the frustum.
bool in_frustum(uvec3 block) {
    const vec3 low = vec3(block * BLOCK);
    const vec3 high = min(low + float(BLOCK), vec3(grid.voxels.xyz) - 1.0);
    for (int i = 0; i < 6; ++i) {
        const vec4 plane = frame.planes[i];
        const vec3 farthest = mix(low, high, greaterThan(plane.xyz, vec3(0.0)));
        if (dot(plane.xyz, farthest) + plane.w < 0.0) return false;
    }
    return true;
}

void main() {
    const uint place = gl_LocalInvocationIndex;
    for (uint i = gl_WorkGroupID.x; i < group_count; i += gl_NumWorkGroups.x) {
        const uint group = active_groups[i].x;
        if (place == 0) drawn_mask = 0;
        barrier();
        const bool active_block = (active_groups[i].y >> place & 1) != 0;
        const bool drawn =
            active_block && (!CULLING || in_frustum(group_origin(group) + block_in_group(place)));
        if (drawn) atomicOr(drawn_mask, 1u << place);
        barrier();
        const uint chunk = group / CHUNK_GROUPS;
        if (place == 0 && drawn_mask != 0) {
            first_entry = atomicAdd(draws[chunk].blocks, bitCount(drawn_mask));
            atomicAdd(counters.blocks_drawn, bitCount(drawn_mask));
        }
        barrier();
        if (drawn) {
            const uint rank = bitCount(drawn_mask & ((1u << place) - 1));
            drawn_blocks[chunk * CHUNK_BLOCKS + first_entry + rank] =
                uint16_t(group % CHUNK_GROUPS * GROUP_BLOCKS + place);
        }
        barrier();
    }
}
