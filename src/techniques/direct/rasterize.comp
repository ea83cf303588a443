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
// variant rasterize_counting: -DCOUNTING
// variant rasterize_large: -DLARGE
// variant rasterize_large_numbered: -DLARGE -DNUMBERED
// variant rasterize_large_counting: -DLARGE -DCOUNTING
// Workgroup: one block of 8^3 cells. Thread: voxels, then rows, then cells, then vertices, then
// triangles; LARGE, for blocks that are large in the picture: pixels. Out: the depth of the surface's
// triangles there. Extraction and rasterization in one compute shader: no mesh shaders, no graphics
// queue.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/ray.glsl"
#include "techniques/direct/list.glsl"
#include "techniques/direct/drawn.glsl"

#ifndef THREADS
#define THREADS 128
#endif
layout(local_size_x = THREADS) in;

// Marching cubes: of each case's five possible triangles, where the corners' vertices are
// (corner_vertex); in the first one, bits 29..31, how many there are.
layout(set = 1, binding = 2, std430) readonly buffer TriangleTable { uint triangle_table[]; };
// Depth as the bits of floats: of numbers that are not negative, the order is the same.
layout(set = 1, binding = 3, r32ui) uniform uimage2DArray depth_bits;
layout(set = 1, binding = 4, r32ui) writeonly uniform uimage2DArray surface_numbers;
layout(set = 1, binding = 5, std430) readonly buffer Pyramid { float pyramid[]; };
layout(constant_id = 1) const bool CLIPPED = false;  // by clip planes
// Whether depth is the plane through the vertices' positions on the grid of 1/256 pixels, as GPUs
// have it, or through those before rounding, as lavapipe has it.
layout(constant_id = 2) const bool SNAPPED = false;
// Whether eighths of the block that depth already drawn hides, by the pyramid, are left out.
layout(constant_id = 3) const bool OCCLUSION = false;

#include "shaders/cell_rows.glsl"

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
    if (imageAtomicMax(depth_bits, place, bits) < bits)
        imageStore(surface_numbers, place, uvec4(surface));
#else
    imageAtomicMax(depth_bits, place, floatBitsToUint(depth));
#endif
}

#include "techniques/direct/triangle.glsl"

const uint ROWS = 81, CORNERS = 729;
// What fits the 16 KiB of shared memory that every device has. Blocks with more are worked off in
// layers of 2x8x8 cells, of which every one fits: they have at most 594 crossed edges and 640
// triangles.
const uint MAX_VERTICES = 640, MAX_TRIANGLES = 1024, THIN = 2;

shared float values[CORNERS];
shared uint signs[ROWS];  // of corner rows
shared uvec2 rows[ROWS];  // crossed edges of corner rows, and the first one's number, in these layers
// First x: the vertices' edges, y: occupied cells (x + 8 y + 64 z). Then the vertices' pixels and depth, as bits.
shared uint vertex_x[MAX_VERTICES], vertex_y[MAX_VERTICES], vertex_z[MAX_VERTICES];
shared uint triangles[MAX_TRIANGLES];  // cell | place in triangle_table << 9
shared uint row_totals;                // vertices | cells << 16
shared uint triangle_total;

// Takes `count` places in a list whose length is the shared `total`; `first` becomes the first one.
// One atomic operation a subgroup where the device can count across it: threads wait for each other
// at the same address.
#ifdef SUBGROUPS
#define RESERVE(total, count, first)                       \
    first = subgroupAdd(count);                            \
    if (subgroupElect()) first = atomicAdd(total, first);  \
    first = subgroupBroadcastFirst(first) + subgroupExclusiveAdd(count);
#else
#define RESERVE(total, count, first) first = atomicAdd(total, count);
#endif

// A row of nine corners a thread: their values, all fetches on their way before the first one's
// result is waited for, and their signs.
void load_rows(uvec3 first, float iso) {
    const Brick brick = brick_of(ivec3(first));
    const int last = int(grid.voxels.x) - 1 - int(first.x);
    for (uint row = gl_LocalInvocationIndex; row < ROWS; row += THREADS) {
        const ivec3 start = clamp_to_volume(ivec3(first + uvec3(0, row % 9, row / 9)));
        float loaded[9];
        [[unroll]] for (int x = 0; x < 9; ++x)
            loaded[x] = voxel(brick, start + ivec3(min(x, last), 0, 0));
        uint bits = 0;
        [[unroll]] for (int x = 0; x < 9; ++x) {
            values[9 * row + x] = loaded[x];
            bits |= (loaded[x] >= iso ? 1u : 0u) << x;
        }
        signs[row] = bits;
    }
}

// Cells along x that have surface. Rows beyond the block's last have none.
uint occupied_in_row(uint row, ivec3 left) {
    const uint y = row % 9, z = row / 9;
    if (y >= 8 || z >= 8 || int(y) >= left.y || int(z) >= left.z) return 0;
    return occupied_cells(CellRow(signs[row], signs[row + 1], signs[row + 9], signs[row + 10])) &
           ((1u << clamp(left.x, 0, 8)) - 1);
}

#include "techniques/direct/octants.glsl"

// Lists the vertices on the edges of corner rows, and the occupied cells of cell rows that are in
// these octants; of the cell layers from `layer` on.
void list_rows(uint layer, uint layers, ivec3 left, uint octants) {
    const uint exist = (1u << clamp(left.x, 0, 8)) - 1, corners = exist << 1 | 1;
    for (uint row = gl_LocalInvocationIndex; row < ROWS; row += THREADS) {
        const uint y = row % 9, z = row / 9;
        uint mask = 0, occupied = 0;
        if (z >= layer && z <= layer + layers && int(y) <= left.y && int(z) <= left.z) {
            mask = exist | (int(y) < min(left.y, 8) ? corners << 8 : 0) |
                   (int(z) < min(left.z, int(layer + layers)) ? corners << 17 : 0);
            if (z < layer + layers)
                occupied = occupied_in_row(row, left) & cells_of_octants(octants, y, z);
        }
        const uint crossed = edge_bits(signs[row], signs[min(row + 1, ROWS - 1)],
                                       signs[min(row + 9, ROWS - 1)]) & mask;
        const uint counts = bitCount(crossed) | bitCount(occupied) << 16;
        uint first;
        RESERVE(row_totals, counts, first)
        uint vertex = first & 0xffffu, cell = first >> 16;
        rows[row] = uvec2(crossed, vertex);
        // Straight through all bits: that takes less time than to look for the next one set.
        [[unroll]] for (uint bit = 0; bit < 26; ++bit)
            if ((crossed >> bit & 1) != 0 && vertex < MAX_VERTICES)
                vertex_x[vertex++] = row << 5 | bit;
        [[unroll]] for (uint x = 0; x < 8; ++x)
            if ((occupied >> x & 1) != 0) vertex_y[cell++] = z << 6 | y << 3 | x;
    }
}

void list_triangles() {
    const uint cell_total = row_totals >> 16;
    for (uint i = gl_LocalInvocationIndex; i < cell_total; i += THREADS) {
        const uint cell = vertex_y[i], row = corner_row(cell >> 3 & 7u, cell >> 6);
        const CellRow corners = CellRow(signs[row], signs[row + 1], signs[row + 9], signs[row + 10]);
        const uint entry = 5 * cell_case(corners, cell & 7u);
        const uint count = triangle_table[entry] >> 29;
        uint triangle;
        RESERVE(triangle_total, count, triangle)
        [[unroll]] for (uint number = 0; number < 5; ++number)
            if (number < count && triangle + number < MAX_TRIANGLES)
                triangles[triangle + number] = cell | entry + number << 9;
    }
}

// A listed triangle: the corner row and the place in it from which its corners are counted, and
// where they are.
struct Listed {
    uint row, x, corners;
};
Listed listed(uint i) {
    const uint cell = triangles[i] & 511u;
    return Listed(corner_row(cell >> 3 & 7u, cell >> 6), cell & 7u, triangle_table[triangles[i] >> 9]);
}

// The edge that a triangle's corner lies on: nine bits a corner, four for the row and five for the
// edge's bit there.
uint corner_edge(Listed triangle, uint corner) {
    const uint where = triangle.corners >> 9 * corner;
    return triangle.row + (where & 15u) << 5 | triangle.x + (where >> 4 & 31u);
}

// Clip space: the one place where voxels meet the camera.
vec4 vertex_on(uint eye, uint edge, uvec3 first, float iso) {
    const uvec3 corner = edge_corner(edge);
    const uint axis = edge_axis(edge), at = corner.x + 9 * (edge >> 5);
    const float lower = values[at], upper = values[at + (axis == 0 ? 1 : axis == 1 ? 9 : 81)];
    precise const vec4 clip =
        frame.eyes[eye].clip_from_voxel * vec4(crossing(first + corner, axis, lower, upper, iso), 1.0);
    return clip;
}

// Pixels, from the middle of the first one, and depth.
vec3 to_screen(vec4 clip) {
    const vec2 half_size = 0.5 * vec2(frame.size.xy);
    precise const float inverse = 1.0 / clip.w;
    precise const vec2 pixel = clip.xy * inverse * half_size + (half_size - 0.5);
    precise const float depth = clip.z * inverse;
    return vec3(SNAPPED ? roundEven(pixel * 256.0) / 256.0 : pixel, depth);
}

#ifdef LARGE
#include "techniques/direct/clip.glsl"

// So many threads take a triangle together.
const uint TEAM = 32;

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
            rasterize_large(eye, to_screen(polygon.corners[0]),
                            to_screen(polygon.corners[corner - 1]),
                            to_screen(polygon.corners[corner]), thread, TEAM);
    }
}
#else
void project_vertices(uint eye, uvec3 first, float iso) {
    const uint vertex_total = row_totals & 0xffffu;
    for (uint i = gl_LocalInvocationIndex; i < vertex_total; i += THREADS) {
        const vec3 screen = to_screen(vertex_on(eye, vertex_x[i], first, iso));
        vertex_x[i] = floatBitsToUint(screen.x);
        vertex_y[i] = floatBitsToUint(screen.y);
        vertex_z[i] = floatBitsToUint(screen.z);
    }
}

vec3 corner_vertex(Listed triangle, uint corner) {
    const uint where = triangle.corners >> 9 * corner;
    const uvec2 row = rows[triangle.row + (where & 15u)];
    const uint bit = triangle.x + (where >> 4 & 31u), i = row.y + bitCount(row.x & (1u << bit) - 1);
    return uintBitsToFloat(uvec3(vertex_x[i], vertex_y[i], vertex_z[i]));
}

void rasterize(uint eye, uvec3 first, float iso) {
    project_vertices(eye, first, iso);
    barrier();
    for (uint i = gl_LocalInvocationIndex; i < triangle_total; i += THREADS) {
        const Listed triangle = listed(i);
        rasterize_small(eye, corner_vertex(triangle, 0), corner_vertex(triangle, 1),
                        corner_vertex(triangle, 2));
    }
}
#endif

bool fits() {
    return (row_totals & 0xffffu) <= MAX_VERTICES && triangle_total <= MAX_TRIANGLES;
}

void draw_block(uvec3 first, float iso) {
    const ivec3 left = cells_left(first);
    load_rows(first, iso);
    const uint octants = OCCLUSION ? visible_octants(first, left) : ALL_OCTANTS;
    uint layer = 0, layers = BLOCK;
    while (layer < BLOCK && octants != 0) {
        bool drawn = true;
        for (uint eye = 0; eye < frame.counts.x && drawn; ++eye) {
            if (gl_LocalInvocationIndex == 0) row_totals = triangle_total = 0;
            barrier();
            list_rows(layer, layers, left, octants);
            barrier();
            list_triangles();
            barrier();
            drawn = fits();
            if (drawn) rasterize(eye, first, iso);
            barrier();
        }
        if (drawn) layer += layers;
        else layers = THIN;
    }
}

// A workgroup draws one block of its quartet, or all.
void main() {
    const float iso = frame.surfaces[surface].w;
    for (uint n = gl_WorkGroupID.z; n < 4; n += gl_NumWorkGroups.z) {
        uvec3 block;
        if (!my_block(n, block)) return;
        draw_block(block * BLOCK, iso);
    }
}
