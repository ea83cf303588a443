#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: 4^3 nodes of one level of the pyramid. Thread: one node. Out: the min-max of its up to
// eight children.
#define SCENE_WRITES_MINMAX
#include "shaders/scene.glsl"
#include "grid/store_node.glsl"

layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

layout(push_constant) uniform Push { uint level; };

void main() {
    const uvec3 node = gl_GlobalInvocationID;
    if (any(greaterThanEqual(node, grid.levels[level].xyz))) return;
    const uvec3 last = grid.levels[level - 1].xyz - 1;
    vec2 range = node_range(node_index(level - 1, 2 * node));
    for (uint c = 1; c < 8; ++c) {
        const uvec3 child = min(2 * node + uvec3(c & 1, c >> 1 & 1, c >> 2), last);
        const vec2 other = node_range(node_index(level - 1, child));
        range = vec2(min(range.x, other.x), max(range.y, other.y));
    }
    store_node(node_index(level, node), range);
}
