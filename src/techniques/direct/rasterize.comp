#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// variant rasterize_numbered: -DNUMBERED
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

const uint THREADS = 128;
layout(local_size_x = THREADS) in;

// Marching cubes: of each case's five possible triangles, where the corners' vertices are
// (corner_vertex); in the first one, bits 29..31, how many there are.
layout(set = 1, binding = 2, std430) readonly buffer TriangleTable { uint triangle_table[]; };
// Depth as the bits of floats: of numbers that are not negative, the order is the same.
layout(set = 1, binding = 3, r32ui) uniform uimage2DArray depth_bits;
layout(set = 1, binding = 4, r32ui) writeonly uniform uimage2DArray surface_numbers;
layout(constant_id = 1) const bool CLIPPED = false;  // by clip planes
// Whether depth is the plane through the vertices' positions on the grid of 1/256 pixels, as GPUs
// have it, or through those before rounding, as lavapipe has it.
layout(constant_id = 2) const bool SNAPPED = false;

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
// First x: the vertices' edges, y: occupied cells. Then the vertices' pixels and depth, as bits.
shared uint vertex_x[MAX_VERTICES], vertex_y[MAX_VERTICES], vertex_z[MAX_VERTICES];
shared uint triangles[MAX_TRIANGLES];  // cell | place in triangle_table << 9
shared uint vertex_total, cell_total, triangle_total;

// All fetches are on their way before the first one's result is waited for.
void load_values(uvec3 first) {
    const uint ROUNDS = (CORNERS + THREADS - 1) / THREADS;
    const Brick brick = brick_of(ivec3(first));
    float loaded[ROUNDS];
    [[unroll]] for (uint round = 0; round < ROUNDS; ++round) {
        const uint i = min(gl_LocalInvocationIndex + round * THREADS, CORNERS - 1);
        loaded[round] =
            voxel(brick, clamp_to_volume(ivec3(first + uvec3(i % 9, i / 9 % 9, i / 81))));
    }
    [[unroll]] for (uint round = 0; round < ROUNDS; ++round)
        values[min(gl_LocalInvocationIndex + round * THREADS, CORNERS - 1)] = loaded[round];
}

void find_signs(float iso) {
    for (uint row = gl_LocalInvocationIndex; row < ROWS; row += THREADS) {
        uint bits = 0;
        for (uint x = 0; x < 9; ++x) bits |= (values[9 * row + x] >= iso ? 1u : 0u) << x;
        signs[row] = bits;
    }
}

// Lists the vertices on a corner row's edges, of the cell layers from `layer` on.
void list_vertices(uint row, uint layer, uint layers, ivec3 left) {
    const uint y = row % 9, z = row / 9;
    const uint cells = left.x >= 8 ? 0xffu : (1u << max(left.x, 0)) - 1, corners = cells << 1 | 1;
    uint mask = 0;
    if (z >= layer && z <= layer + layers && int(y) <= left.y && int(z) <= left.z) {
        mask = cells;
        if (int(y) < min(left.y, 8)) mask |= corners << 8;
        if (int(z) < min(left.z, int(layer + layers))) mask |= corners << 17;
    }
    const uint bits = edge_bits(signs[row], signs[min(row + 1, ROWS - 1)],
                                signs[min(row + 9, ROWS - 1)]) & mask;
    uint vertex = bits == 0 ? 0 : atomicAdd(vertex_total, bitCount(bits));
    rows[row] = uvec2(bits, vertex);
    for (uint rest = bits; rest != 0 && vertex < MAX_VERTICES; rest &= rest - 1)
        vertex_x[vertex++] = row << 5 | findLSB(rest);
}

// Lists the occupied cells of a cell row: cell | case << 9.
void list_cells(uint row, uint layer, uint layers, ivec3 left) {
    const uint y = row & 7u, z = row >> 3;
    if (z < layer || z >= layer + layers || int(y) >= left.y || int(z) >= left.z) return;
    const CellRow corners = CellRow(signs[corner_row(y, z)], signs[corner_row(y + 1, z)],
                                    signs[corner_row(y, z + 1)], signs[corner_row(y + 1, z + 1)]);
    const uint exist = left.x >= 8 ? 0xffu : (1u << max(left.x, 0)) - 1;
    uint occupied = occupied_cells(corners) & exist;
    uint i = occupied == 0 ? 0 : atomicAdd(cell_total, bitCount(occupied));
    for (; occupied != 0; occupied &= occupied - 1) {
        const uint x = findLSB(occupied);
        vertex_y[i++] = row << 3 | x | cell_case(corners, x) << 9;
    }
}

void list_triangles() {
    for (uint i = gl_LocalInvocationIndex; i < cell_total; i += THREADS) {
        const uint cell = vertex_y[i] & 511u, entry = 5 * (vertex_y[i] >> 9);
        const uint count = triangle_table[entry] >> 29;
        const uint triangle = atomicAdd(triangle_total, count);
        for (uint number = 0; number < count && triangle + number < MAX_TRIANGLES; ++number)
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
vec4 project(uint eye, uint edge, uvec3 first, float iso) {
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
            polygon.corners[corner] = project(eye, corner_edge(triangle, corner), first, iso);
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
    for (uint i = gl_LocalInvocationIndex; i < vertex_total; i += THREADS) {
        const vec3 screen = to_screen(project(eye, vertex_x[i], first, iso));
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

void main() {
    const uint thread = gl_LocalInvocationIndex;
    const float iso = frame.surfaces[surface].w;
    uvec3 block;
    if (!my_block(gl_WorkGroupID.z, block)) return;
    const uvec3 first = block * BLOCK;
    const ivec3 left = cells_left(first);
    load_values(first);
    barrier();
    find_signs(iso);

    uint layer = 0, layers = BLOCK;
    while (layer < BLOCK) {
        for (uint eye = 0; eye < frame.counts.x; ++eye) {
            if (thread == 0) vertex_total = cell_total = triangle_total = 0;
            barrier();
            if (thread < ROWS) list_vertices(thread, layer, layers, left);
            if (thread >= THREADS - 64) list_cells(thread - (THREADS - 64), layer, layers, left);
            barrier();
            list_triangles();
            barrier();
            if (vertex_total > MAX_VERTICES || triangle_total > MAX_TRIANGLES) break;
            rasterize(eye, first, iso);
            barrier();
        }
        const bool too_many = vertex_total > MAX_VERTICES || triangle_total > MAX_TRIANGLES;
        barrier();
        if (too_many) layers = THIN;
        else layer += layers;
    }
}
