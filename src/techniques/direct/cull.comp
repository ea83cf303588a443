#version 460
#extension GL_GOOGLE_include_directive : require
// Workgroup: one active group at a time. Thread: one block. Out: the list of blocks to draw, in
// chunks, and the indirect arguments to draw it. Culling is in two passes (Kreskowski 2022,
// section 3.5 and figure 2, with a depth pyramid in place of raster proxies): blocks that the last
// frame saw are drawn first; then those of all others that they do not hide.
#include "shaders/scene.glsl"
#include "techniques/direct/list.glsl"
#include "techniques/direct/pyramid.glsl"

layout(local_size_x = 32) in;

const uint ALL = 0, SEEN = 1, UNSEEN = 2;
layout(constant_id = 1) const uint SELECT = ALL;

layout(set = 1, binding = 0, std430) readonly buffer ActiveGroups {
    uint dispatch_x, dispatch_y, dispatch_z;
    uint group_count;
    uvec2 active_groups[];
};
struct DrawArguments {
    uint blocks, workgroups, one;  // as VkDispatchIndirectCommand
};
layout(set = 1, binding = 1, std430) buffer Draws { DrawArguments draws[]; };
layout(set = 1, binding = 2, std430) writeonly buffer DrawnBlocks { uint16_t drawn_blocks[]; };
layout(set = 1, binding = 3, std430) buffer CounterBlock { Counters counters; };
layout(set = 1, binding = 4, std430) readonly buffer SeenBlocks { uint seen_blocks[]; };
layout(set = 1, binding = 5, std430) readonly buffer Pyramid { float pyramid[]; };

shared uint drawn_mask;
shared uint first_entry;

// True unless the whole block lies outside one plane of the frustum.
bool in_frustum(vec3 low, vec3 high) {
    for (int i = 0; i < 6; ++i) {
        const vec4 plane = frame.planes[i];
        const vec3 farthest = mix(low, high, greaterThan(plane.xyz, vec3(0.0)));
        if (dot(plane.xyz, farthest) + plane.w < 0.0) return false;
    }
    return true;
}

// True if depth already drawn is nearer than all of the block, at every pixel that the block can
// touch.
bool is_hidden(vec3 low, vec3 high) {
    vec2 least = vec2(1e9), greatest = vec2(-1e9);
    float nearest = 0.0;
    for (int c = 0; c < 8; ++c) {
        const vec3 corner = mix(low, high, vec3(c & 1, c >> 1 & 1, c >> 2));
        const vec4 clip = frame.clip_from_voxel * vec4(corner, 1.0);
        if (clip.w <= 0.0 || clip.z >= clip.w) return false;  // before the near plane
        const vec2 pixel = (0.5 + 0.5 * clip.xy / clip.w) * vec2(frame.size.xy);
        least = min(least, pixel);
        greatest = max(greatest, pixel);
        nearest = max(nearest, clip.z / clip.w);
    }
    // A rounding error of the projection must not hide anything: a hundredth of a pixel, 1e-5 of
    // the depth.
    const vec2 last = vec2(frame.size.xy) - 1.0;
    const uvec2 low_pixel = uvec2(clamp(floor(least - 0.01), vec2(0.0), last));
    const uvec2 high_pixel = uvec2(clamp(floor(greatest + 0.01), vec2(0.0), last));
    const float limit = nearest * 1.00001 + 1e-7;
    // The finest level at which the block covers at most 4x4 squares.
    uint level = 1;
    while (level < PYRAMID_LEVELS &&
           any(greaterThan((high_pixel >> level) - (low_pixel >> level), uvec2(3)))) ++level;
    const uvec2 first = low_pixel >> level, end = high_pixel >> level;
    if (any(greaterThan(end - first, uvec2(15)))) return false;  // larger than a thousand pixels
    const uint offset = pyramid_offset(level), width = pyramid_size(level).x;
    for (uint y = first.y; y <= end.y; ++y)
        for (uint x = first.x; x <= end.x; ++x)
            if (pyramid[offset + x + width * y] <= limit) return false;
    return true;
}

bool is_selected(uvec3 block, bool seen) {
    if (SELECT == ALL) return true;
    if (seen != (SELECT == SEEN)) return false;
    const vec3 low = vec3(block * BLOCK);
    const vec3 high = min(low + float(BLOCK), vec3(grid.voxels.xyz) - 1.0);
    return in_frustum(low, high) && (SELECT == SEEN || !is_hidden(low, high));
}

void main() {
    const uint place = gl_LocalInvocationIndex;
    for (uint i = gl_WorkGroupID.x; i < group_count; i += gl_NumWorkGroups.x) {
        const uint group = active_groups[i].x;
        if (place == 0) drawn_mask = 0;
        barrier();
        const bool is_active = (active_groups[i].y >> place & 1) != 0;
        const bool seen = (seen_blocks[group] >> place & 1) != 0;
        const uvec3 block = group_origin(group) + block_in_group(place);
        const bool drawn = is_active && is_selected(block, seen);
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
