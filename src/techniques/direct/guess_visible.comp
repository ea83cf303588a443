#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Workgroup: 8x8 rays, each in the middle of a square of pixels. Thread: one ray. Out: the block
// that it hits, as visible: a guess, after a change.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/ray.glsl"
#include "shaders/cell_root.glsl"
#include "shaders/march.glsl"
#define VISIBLE_BLOCKS_BINDING 0
#include "shaders/visible_blocks.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(push_constant) uniform Push { int side; };  // of a square

// All wait for the last ray, and each ray for what it fetches: so it fetches much at once, takes
// long steps and gives up after so many: soon, where blocks are drawn fast.
layout(constant_id = 3) const uint MOST_STEPS = 1;
const uint SAMPLES = 4;  // across a block

// Whether the ray crosses the surface on its way to `end`, within a block.
bool crosses_block(inout March march, ivec3 block, float end) {
    const Brick brick = brick_of(block * int(BLOCK));
    float values[SAMPLES];
    [[unroll]] for (uint i = 0; i < SAMPLES; ++i) {
        const float t = mix(march.t, end, (float(i) + 0.5) / float(SAMPLES));
        values[i] = field_at(brick, position_at(march, t));
    }
    for (uint i = 0; i < SAMPLES; ++i)
        if (crossed_to(march, values[i] >= march.iso)) return true;
    return false;
}

// Where the ray enters the block in which it hits the surface, as t.
const float NEVER = 1e30;
float guess_hit(Ray ray, float iso) {
    float end;
    March march = begin_march(ray, iso, end);
    for (uint i = 0; i < MOST_STEPS && march.t < end; ++i) {
        const Node node = node_around(position_at(march, march.t + march.nudge), iso);
        const float leave = leave_node(march, node, end);
        if (node.crossed ? crosses_block(march, ivec3(node.place), leave)
                         : crossed_to(march, node.inside))
            return march.t + march.nudge;
        march.t = leave;
    }
    return NEVER;
}

void main() {
    const ivec2 middle = side * ivec2(gl_GlobalInvocationID.xy) + side / 2;
    if (any(greaterThanEqual(middle, ivec2(frame.size.xy)))) return;
    const Ray ray = pixel_ray(gl_GlobalInvocationID.z, vec2(middle));  // z: the eye
    float nearest = NEVER;
    for (uint i = 0; i < frame.size.z; ++i)
        nearest = min(nearest, guess_hit(ray, frame.surfaces[i].w));
    if (nearest < NEVER) mark_visible(cell_of(ray.origin + nearest * ray.direction));
}
