// Descriptor set 0: the frame, the grid, its voxels, its min-max pyramid. Include first.
// Define SCENE_WRITES_MINMAX before including to write the pyramid.
#ifdef BRICKED
#extension GL_EXT_nonuniform_qualifier : require
#endif
#extension GL_EXT_shader_16bit_storage : require
#extension GL_EXT_samplerless_texture_functions : require
#include "shaders/shared.h"

// 8 and 16: integers, seen as [0, 1]; 32: floats. And VOXELS_IN_BUFFER.
layout(constant_id = 0) const uint VOXEL_FORMAT = 8;
const uint VOXEL_BITS = VOXEL_FORMAT & 63u;

layout(set = 0, binding = BIND_FRAME, std140) uniform FrameBlock { FrameInfo frame; };
layout(set = 0, binding = BIND_GRID, std140) uniform GridBlock { GridInfo grid; };
layout(set = 0, binding = BIND_BRICKS) uniform texture3D bricks[MAX_BRICKS];
layout(set = 0, binding = BIND_SAMPLER) uniform sampler linear_sampler;
// The only brick's memory; rows and slices begin at whole words.
layout(set = 0, binding = BIND_VOXELS) readonly buffer Voxels { uint voxels[]; };

#ifdef SCENE_WRITES_MINMAX
#define MINMAX_ACCESS
#else
#define MINMAX_ACCESS readonly
#endif
// The same buffer thrice: a node is 2 bytes for 8-bit voxels, 4 for 16-bit, 8 for floats.
layout(set = 0, binding = BIND_MINMAX) MINMAX_ACCESS buffer MinMax8 { uint16_t minmax_8[]; };
layout(set = 0, binding = BIND_MINMAX) MINMAX_ACCESS buffer MinMax16 { uint minmax_16[]; };
layout(set = 0, binding = BIND_MINMAX) MINMAX_ACCESS buffer MinMax32 { vec2 minmax_32[]; };

// The least and greatest stored value of a node of the pyramid.
vec2 node_range(uint node) {
    if (VOXEL_BITS == 8) {
        const uint bits = uint(minmax_8[node]);
        return vec2(bits & 0xffu, bits >> 8);
    }
    if (VOXEL_BITS == 16) {
        const uint bits = minmax_16[node];
        return vec2(bits & 0xffffu, bits >> 16);
    }
    return minmax_32[node];
}

uint node_index(uint level, uvec3 node) {
    const uvec4 nodes = grid.levels[level];
    return nodes.w + node.x + nodes.x * (node.y + nodes.y * node.z);
}

// A whole number from 0 to 2^23 is in the last bits of its sum with 2^23. CPU drivers convert one
// after the other, and add all at once.
ivec3 to_int(vec3 whole) { return floatBitsToInt(whole + 8388608.0) & 0x7fffff; }
uvec2 to_uint(vec2 whole) { return floatBitsToUint(whole + 8388608.0) & 0x7fffffu; }

// The one tie rule: a value equal to the isovalue is inside.
bool crosses(vec2 range, float iso) { return range.x < iso && range.y >= iso; }
