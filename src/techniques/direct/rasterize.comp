#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#ifdef SUBGROUPS
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#endif
// variant rasterize_numbered: -DNUMBERED
// variant rasterize_subgroups: -DSUBGROUPS
// variant rasterize_subgroups_numbered: -DSUBGROUPS -DNUMBERED
// variant rasterize_subgroups_counting: -DSUBGROUPS -DCOUNTING
// variant rasterize_counting: -DCOUNTING
// variant rasterize_large: -DLARGE
// variant rasterize_large_numbered: -DLARGE -DNUMBERED
// variant rasterize_large_counting: -DLARGE -DCOUNTING
// Workgroup: a block of 8^3 cells; or a quartet's blocks in turn, on a CPU many quartets'
// (workgroups.h); LARGE, for blocks that are large in the picture: on a GPU a part of each. Thread:
// rows of voxels, then of cells, then cells, then vertices, then triangles; LARGE: pixels. Out: the
// depth of the surface's triangles there. Extraction and rasterization in one compute shader: no
// mesh shaders, no graphics queue.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/ray.glsl"
#include "shaders/frustum.glsl"
#include "techniques/direct/list.glsl"

layout(local_size_x = 96, local_size_x_id = 3) in;
const uint THREADS = gl_WorkGroupSize.x;
layout(constant_id = 8) const bool LOCKSTEP = false;
#include "shaders/lockstep.glsl"

// Marching cubes: of each case's five possible triangles, where the corners' vertices are
// (corner_vertex); in the first one, bits 29..31, how many there are.
layout(set = 1, binding = 2, std430) readonly buffer TriangleTable { uint triangle_table[]; };
// Depth as the bits of floats: of numbers that are not negative, the order is the same.
layout(set = 1, binding = 3, r32ui) uniform uimage2DArray depth_bits;
layout(set = 1, binding = 4, r32ui) writeonly uniform uimage2DArray surface_numbers;
// Where the CPU draws: the same depth as words of the image's memory, which lies in rows. To raise
// a word takes less than to raise a texel.
layout(constant_id = 9) const bool DEPTH_IN_BUFFER = false;
layout(set = 1, binding = 6, std430) buffer DepthWords { uint depth_words[]; };
#define PUSHED_TOO uint depth_row, depth_layer;  // how many words
layout(constant_id = 1) const bool CLIPPED = false;  // by clip planes
// Whether depth is the plane through the vertices' positions on the grid of 1/256 pixels, as GPUs
// have it, or through those before rounding, as lavapipe has it.
layout(constant_id = 2) const bool SNAPPED = false;
layout(constant_id = 5) const uint EYES = 1;
// By the depth pyramid: of a block that no pixel sees in the end, though its box sticks out, many
// cells are hidden.
layout(constant_id = 6) const bool CELLS_TESTED = false;
layout(set = 1, binding = 5, std430) readonly buffer Pyramid { float pyramid[]; };
#include "shaders/hidden.glsl"
// Workgroups that share a block, a slab each.
#ifdef LARGE
layout(constant_id = 4) const uint PARTS = 1;
#else
const uint PARTS = 1;
#endif

layout(constant_id = 7) const uint MOST = 0;  // as in workgroups.h
#include "techniques/direct/drawn.glsl"

// The depth before.
uint raise_depth(ivec3 place, uint bits) {
    if (!DEPTH_IN_BUFFER) return imageAtomicMax(depth_bits, place, bits);
    const uint word = depth_layer * uint(place.z) + depth_row * uint(place.y) + uint(place.x);
    return atomicMax(depth_words[word], bits);
}

// Every pixel of every triangle goes through here.
void write_pixel(uint eye, ivec2 pixel, float depth, bool front) {
    if (CLIPPED && !is_kept(eye, vec2(pixel) + 0.5, depth)) return;
    const ivec3 place = ivec3(pixel, eye);
#if defined(COUNTING)
    // A test's: front faces less back faces; 0 everywhere if the surface is closed.
    imageAtomicAdd(depth_bits, place, front ? 1u : ~0u);
#elif defined(NUMBERED)
    // All that a dispatch draws has the same number: whoever raises the depth may write it.
    const uint bits = floatBitsToUint(depth);
    if (raise_depth(place, bits) < bits)
        imageStore(surface_numbers, place, uvec4(surface));
#else
    raise_depth(place, floatBitsToUint(depth));
#endif
}

#include "techniques/direct/triangle.glsl"

// A GPU may have no more than 48 KiB of shared memory a multiprocessor for all workgroups on it,
// and hides their waiting for voxels and for each other by having many: here 12, at 4 KiB each. So
// voxels are not kept, and the lists are as long as most blocks need; blocks with more are worked
// off in slabs: halves, quarters, ... down to half a layer, 8x4x1 cells, which has at most 197
// crossed edges and 160 triangles.
const uint MAX_LISTED = 200;  // vertices, and occupied cells
const uint MAX_TRIANGLES = 360;

#define SIGNS_AT_ONCE 3
#include "techniques/direct/block_lists.glsl"

shared uint row_totals;                // vertices | cells << 16
shared uint triangle_total;
// First the edges that vertices lie on, and the occupied cells. Then the vertices' pixels on the
// grid of 1/256, from the origin, x | y << 16; and their depth.
shared uint vertex_pixels[MAX_LISTED], vertex_depths[MAX_LISTED];
shared vec2 vertex_unsnapped[SNAPPED ? 1 : MAX_LISTED];
shared ivec2 origin;  // a pixel that a corner of the block lies in

// The first one of so many places at the end of a list. One atomic operation a subgroup where the
// device can add across it: threads wait for each other at the same address.
#ifdef SUBGROUPS
uint reserve_rows(uint counts) {  // as row_totals
    const uint up_to = subgroupInclusiveAdd(counts);
    uint first = subgroupMax(up_to);  // of all
    if (subgroupElect()) first = atomicAdd(row_totals, first);
    return subgroupBroadcastFirst(first) + up_to - counts;
}

// One bit of all threads' counts: adds its share to their sum, and returns that of those before.
uint add_bit(uint count, uint bit, inout uint sum) {
    const uvec4 ballot = subgroupBallot((count >> bit & 1u) != 0);
    sum += subgroupBallotBitCount(ballot) << bit;
    return subgroupBallotExclusiveBitCount(ballot) << bit;
}

uint reserve_triangles(uint count) {  // at most 5: three ballots are faster than a sum
    uint first = 0;
    const uint before = add_bit(count, 0, first) + add_bit(count, 1, first) +
                        add_bit(count, 2, first);
    if (subgroupElect()) first = atomicAdd(triangle_total, first);
    return subgroupBroadcastFirst(first) + before;
}
#else
uint reserve_rows(uint counts) { return atomicAdd(row_totals, counts); }
uint reserve_triangles(uint count) { return atomicAdd(triangle_total, count); }
#endif

uint first_row(Slab slab) { return first_corner_row(slab) + gl_LocalInvocationIndex; }

// A row of nine corners a thread.
void load_rows(Slab slab, uvec3 first, float iso) {
    const Brick brick = brick_of(ivec3(first));
    for (uint row = first_row(slab); row < end_corner_row(slab); row += THREADS)
        signs[row] = load_signs(brick, ivec3(first) + ivec3(0, row % 9, row / 9), iso);
}

// The edges of a row's vertices, up to the vertex `end`.
void list_row(uint row, uint crossed, uint end) {
    for (; crossed != 0; crossed ^= 1u << findMSB(crossed))
        vertex_pixels[--end] = row << 5 | findMSB(crossed);
}

// Lists the slab's vertices and its occupied cells. Most slabs are a whole block within the volume:
// then there is less to ask, and this shader's time goes by its instructions.
void list_rows(Slab slab, ivec3 left) {
    const uint cells_x = (1u << clamp(left.x, 0, 8)) - 1;
    const bool whole = slab.count == CELL_ROWS && all(greaterThanEqual(left, ivec3(BLOCK)));
    for (uint row = first_row(slab); row < end_corner_row(slab); row += THREADS) {
        const uint y = row % 9, z = row / 9;
        const CellRow corners = cell_row(row);
        uint crossed, cells = occupied_cells(corners) & cells_x;
        if (whole) {
            crossed = edge_bits(corners.a, corners.b, corners.c) &
                      (EDGES_X | (y < 8 ? EDGES_Y : 0) | (z < 8 ? EDGES_Z : 0));
            cells = max(y, z) < 8 ? cells : 0;
        } else {
            crossed = crossed_edges(corners, y, z, slab, left, cells_x);
            cells = in_slab(slab, y, z, left) ? cells : 0;
        }
        const uint counts = bitCount(crossed) | bitCount(cells) << 16;
        const uint first = reserve_rows(counts);
        rows[row] = uvec2(crossed, first & 0xffffu);
        const uint end = first + counts;
        uint cell = end >> 16;
        if (max(end & 0xffffu, cell) > MAX_LISTED) continue;
        list_row(row, crossed, end & 0xffffu);
        for (; cells != 0; cells ^= 1u << findMSB(cells))
            vertex_depths[--cell] = row << 5 | findMSB(cells);
    }
}

bool rows_fit() { return max(row_totals & 0xffffu, row_totals >> 16) <= MAX_LISTED; }

// True if no eye can see anything of a cell.
bool is_cell_hidden(uvec3 cell) {
    for (uint eye = 0; eye < EYES; ++eye) {
        Extent extent;
        if (!project(eye, vec3(cell), vec3(cell + 1), extent) || !is_small_hidden(eye, extent))
            return false;
    }
    return true;
}

void list_triangles(uvec3 first_cell) {
    const uint cell_total = rows_fit() ? row_totals >> 16 : 0;
    for (uint i = gl_LocalInvocationIndex; i < cell_total; i += THREADS) {
        const uint cell = vertex_depths[i], row = cell >> 5, x = cell & 31u;
        if (CELLS_TESTED && is_cell_hidden(first_cell + uvec3(x, row % 9, row / 9))) continue;
        const uint entry = table_entry(cell_row(row), x);
        const uint count = triangle_count(entry), first = reserve_triangles(count);
        if (first + count <= MAX_TRIANGLES) list_triangles_of(cell, entry, count, first);
    }
}

// Whether the lists hold all.
bool fits() { return rows_fit() && triangle_total <= MAX_TRIANGLES; }

// Clip space: the one place where voxels meet the camera. To fetch two voxels once more is no
// slower than to keep all in shared memory, and leaves room there.
vec4 vertex_on(uint eye, uint edge, uvec3 first, float iso) {
    const uvec3 corner = edge_corner(edge);
    const uint axis = edge_axis(edge);
    const vec2 ends = edge_values(brick_of(ivec3(first)), ivec3(first + corner), axis);
    const vec3 position = crossing(first + corner, axis, ends.x, ends.y, iso);
    precise const vec4 clip = frame.eyes[eye].clip_from_voxel * vec4(position, 1.0);
    return clip;
}

// Pixels, from the middle of the first one, and depth. In the order in which NVIDIA's hardware goes
// about it, so that vertices snap to the same place: from another, some lie 1/256 beside it.
vec3 to_screen(vec4 clip) {
    const vec2 half_size = 0.5 * vec2(frame.size.xy);
    precise const float inverse = 1.0 / clip.w;
    precise const vec2 pixel = clip.xy * half_size * inverse + half_size - 0.5;
    precise const float depth = clip.z * inverse;
    return vec3(pixel, depth);
}

#ifdef LARGE
#include "techniques/direct/clip.glsl"

void rasterize(uint eye, uvec3 first, float iso) {
    const uint thread = gl_LocalInvocationIndex % TEAM;
    for (uint i = gl_LocalInvocationIndex / TEAM; i < triangle_total; i += THREADS / TEAM) {
        const Listed triangle = listed(i);
        Polygon polygon;
        polygon.count = 3;
        for (uint corner = 0; corner < 3; ++corner)
            polygon.corners[corner] = vertex_on(eye, corner_edge(triangle, corner), first, iso);
        if (needs_clipping(polygon.corners[0]) || needs_clipping(polygon.corners[1]) ||
            needs_clipping(polygon.corners[2]))
            clip_polygon(polygon);
        for (uint corner = 2; corner < polygon.count; ++corner)
            rasterize_large(eye, vertex_at(to_screen(polygon.corners[0])),
                            vertex_at(to_screen(polygon.corners[corner - 1])),
                            vertex_at(to_screen(polygon.corners[corner])), thread);
    }
    wait_for_all();
}
#else
void find_origin(uint eye, uvec3 first) {
    if (gl_LocalInvocationIndex == THREADS - 1)
        origin = ivec2(to_screen(frame.eyes[eye].clip_from_voxel * vec4(first, 1.0)).xy);
}

// The vertices once more, for another eye.
void list_again(Slab slab, uint eye, uvec3 first) {
    wait_for_all();
    for (uint row = first_row(slab); row < end_corner_row(slab); row += THREADS)
        list_row(row, rows[row].x, rows[row].y + bitCount(rows[row].x));
    find_origin(eye, first);
    wait_for_all();
}

// On the grid of 1/256 pixels, a vertex of a small block lies less than 128 pixels from its origin:
// two times 16 bits.
void project_vertices(uint eye, uvec3 first, float iso) {
    const uint vertex_total = row_totals & 0xffffu;
    for (uint i = gl_LocalInvocationIndex; i < vertex_total; i += THREADS) {
        const Vertex vertex = vertex_at(to_screen(vertex_on(eye, vertex_pixels[i], first, iso)));
        const ivec2 from_origin = vertex.pixel - 256 * origin;
        vertex_pixels[i] = uint(from_origin.x & 0xffff) | uint(from_origin.y) << 16;
        vertex_depths[i] = floatBitsToUint(vertex.depth);
        if (!SNAPPED) vertex_unsnapped[i] = vertex.unsnapped;
    }
}

Vertex vertex_of(Listed triangle, uint corner, ivec2 from) {
    const uint i = corner_vertex(triangle, corner);
    const int pixel = int(vertex_pixels[i]);
    Vertex vertex;
    vertex.pixel = ivec2(pixel << 16 >> 16, pixel >> 16);
    vertex.depth = uintBitsToFloat(vertex_depths[i]);
    vertex.unsnapped = SNAPPED ? vec2(vertex.pixel + 256 * from) / 256.0 : vertex_unsnapped[i];
    return vertex;
}

// Without a barrier behind it: a thread may go on to the next slab or block, and load its rows,
// while others still draw. So what is set there before the next barrier is read here before this.
void rasterize(uint eye, uvec3 first, float iso) {
    const uint total = triangle_total;
    const ivec2 from = origin;
    if (total != 0) project_vertices(eye, first, iso);
    wait_for_all();
    for (uint i = gl_LocalInvocationIndex; i < total; i += THREADS) {
        const Listed triangle = listed(i);
        rasterize_small(eye, from, vertex_of(triangle, 0, from), vertex_of(triangle, 1, from),
                        vertex_of(triangle, 2, from));
    }
}
#endif

void draw_block(uint part, uvec3 first, float iso) {
    const ivec3 left = cells_left(first);
    Slab slab = Slab(part * CELL_ROWS / PARTS, CELL_ROWS / PARTS);
    const uint end = slab.first + slab.count;
    load_rows(slab, first, iso);
    while (slab.first < end) {
        if (gl_LocalInvocationIndex == 0) row_totals = triangle_total = 0;
#ifndef LARGE
        find_origin(0, first);
#endif
        wait_for_all();
        list_rows(slab, left);
        wait_for_all();
        list_triangles(first);
        wait_for_all();
        const bool all = fits();
        for (uint eye = 0; eye < EYES && all; ++eye) {
#ifndef LARGE
            if (eye > 0) list_again(slab, eye, first);
#endif
            rasterize(eye, first, iso);
        }
        if (all) {
            slab.first += slab.count;
        } else {
            slab.count /= 2;
            wait_for_all();
        }
    }
}

// A workgroup draws one block of its quartets, or all, or a part of each.
void main() {
    const float iso = frame.surfaces[surface].w;
    uint i = 0;
    do {
        uint entry;
        if (!my_quartet(i, entry)) return;
        ++i;
        for (uint n = gl_WorkGroupID.z / PARTS; n < 4; n += gl_NumWorkGroups.z / PARTS) {
            uvec3 block;
            if (!drawn_block(entry, n, block)) break;
            draw_block(gl_WorkGroupID.z % PARTS, block * BLOCK, iso);
        }
    } while (MOST != 0);
}
