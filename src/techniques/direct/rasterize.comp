#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// variant rasterize_numbered: -DNUMBERED
// variant rasterize_counting: -DCOUNTING
// Workgroup: one block of 8^3 cells. Thread: voxels, then rows, then vertices, then triangles. Out:
// the depth of the surface's triangles there, each vertex computed once. Extraction and
// rasterization in one compute shader: no mesh shaders, no graphics queue.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/ray.glsl"
#include "techniques/direct/list.glsl"
#include "techniques/direct/drawn.glsl"

const uint THREADS = 128;
layout(local_size_x = THREADS) in;

layout(set = 1, binding = 1, std430) readonly buffer Cases { uvec2 cases[]; };
// Depth as the bits of floats: of numbers that are not negative, the order is the same.
layout(set = 1, binding = 2, r32ui) uniform uimage2DArray depth_bits;
layout(set = 1, binding = 3, r32ui) writeonly uniform uimage2DArray surface_numbers;
layout(constant_id = 1) const bool CLIPPED = false;  // by clip planes

uint eye = 0;  // that all threads draw for

#include "shaders/cell_rows.glsl"

// Every pixel of every triangle goes through here.
void write_pixel(ivec2 pixel, float depth, bool front) {
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

#include "techniques/direct/clip.glsl"
#include "techniques/direct/triangle.glsl"

const uint ROWS = 81, CORNERS = 729;
// What fits the 16 KiB of shared memory that every device has. Blocks with more are worked off in
// layers of 2x8x8 cells, of which every one fits: they have at most 594 crossed edges and 640
// triangles.
const uint MAX_VERTICES = 640, MAX_TRIANGLES = 1024, THIN = 2;

shared float values[CORNERS];
shared uint signs[ROWS];         // of corner rows
shared uint edges[ROWS];         // crossed edges of corner rows, in these layers
shared uint first_vertex[ROWS];  // of a corner row's edges
// First the vertex's edge in x; then its pixel and depth, as bits.
shared uint vertex_x[MAX_VERTICES], vertex_y[MAX_VERTICES], vertex_z[MAX_VERTICES];
shared uint triangles[MAX_TRIANGLES];  // cell row << 6 | x << 3 | number in the cell
shared uint vertex_total, triangle_total, large_total;

const uint LARGE = 1u << 31;       // in triangles[]: left to all threads together
const uint UNCLIPPED = 0xbf800000u;  // -1, a vertex's depth where there is none before clipping

void load_values(uvec3 first, float iso) {
    const Brick brick = brick_of(ivec3(first));
    for (uint i = gl_LocalInvocationIndex; i < CORNERS; i += THREADS) {
        const ivec3 corner = ivec3(first + uvec3(i % 9, i / 9 % 9, i / 81));
        values[i] = voxel(brick, clamp_to_volume(corner));
    }
    barrier();
    for (uint row = gl_LocalInvocationIndex; row < ROWS; row += THREADS) {
        uint bits = 0;
        for (uint x = 0; x < 9; ++x) bits |= (values[9 * row + x] >= iso ? 1u : 0u) << x;
        signs[row] = bits;
    }
}

CellRow cell_row(uint row) {
    const uint y = row & 7u, z = row >> 3;
    return CellRow(signs[corner_row(y, z)], signs[corner_row(y + 1, z)],
                   signs[corner_row(y, z + 1)], signs[corner_row(y + 1, z + 1)]);
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
    edges[row] = bits;
    first_vertex[row] = vertex;
    for (uint rest = bits; rest != 0 && vertex < MAX_VERTICES; rest &= rest - 1)
        vertex_x[vertex++] = row << 5 | findLSB(rest);
}

void list_triangles(uint row, uint layer, uint layers, ivec3 left) {
    const uint y = row & 7u, z = row >> 3;
    if (z < layer || z >= layer + layers || int(y) >= left.y || int(z) >= left.z) return;
    const uint cells = left.x >= 8 ? 0xffu : (1u << max(left.x, 0)) - 1;
    const CellRow corners = cell_row(row);
    const uint count = row_triangles(corners, cells);
    if (count == 0) return;
    uint triangle = atomicAdd(triangle_total, count);
    if (triangle + count > MAX_TRIANGLES) return;
    for (uint bits = occupied_cells(corners) & cells; bits != 0; bits &= bits - 1) {
        const uint x = findLSB(bits), in_cell = triangle_count(cell_case(corners, x));
        for (uint number = 0; number < in_cell; ++number)
            triangles[triangle++] = row << 6 | x << 3 | number;
    }
}

// Clip space: the one place where voxels meet the camera.
vec4 project(uint edge, uvec3 first, float iso) {
    const uvec3 corner = edge_corner(edge);
    const uint axis = edge_axis(edge), at = corner.x + 9 * (edge >> 5);
    const float lower = values[at], upper = values[at + (axis == 0 ? 1 : axis == 1 ? 9 : 81)];
    precise const vec4 clip =
        frame.eyes[eye].clip_from_voxel * vec4(crossing(first + corner, axis, lower, upper, iso), 1.0);
    return clip;
}

// Pixels and depth.
vec3 to_screen(vec4 clip) {
    const vec2 half_size = 0.5 * vec2(frame.size.xy);
    precise const float inverse = 1.0 / clip.w;
    precise const vec2 pixel = clip.xy * inverse * half_size + half_size;
    precise const float depth = clip.z * inverse;
    return vec3(pixel, depth);
}

void project_vertices(uvec3 first, float iso) {
    for (uint i = gl_LocalInvocationIndex; i < vertex_total; i += THREADS) {
        const vec4 clip = project(vertex_x[i], first, iso);
        const vec3 screen = to_screen(clip);
        vertex_x[i] = floatBitsToUint(screen.x);
        vertex_y[i] = floatBitsToUint(screen.y);
        vertex_z[i] = needs_clipping(clip) ? UNCLIPPED : floatBitsToUint(screen.z);
    }
}

// The edges of a listed triangle's corners.
uvec3 edges_of(uint triangle) {
    const uint row = triangle >> 6, x = triangle >> 3 & 7u, number = triangle & 7u;
    const uvec2 entry = cases[cell_case(cell_row(row), x)];
    uvec3 result;
    for (uint i = 0; i < 3; ++i)
        result[i] = edge_of_cell(triangle_edge(entry, number, i), x, row & 7u, row >> 3);
    return result;
}

uvec3 vertex_on(uint edge) {
    const uint row = edge >> 5, bit = edge & 31u;
    const uint i = first_vertex[row] + bitCount(edges[row] & ((1u << bit) - 1));
    return uvec3(vertex_x[i], vertex_y[i], vertex_z[i]);
}

// Each thread its own triangles; large ones are marked and left.
void rasterize_alone() {
    for (uint i = gl_LocalInvocationIndex; i < triangle_total; i += THREADS) {
        if (eye > 0) triangles[i] &= ~LARGE;
        const uint triangle = triangles[i];
        const uvec3 on = edges_of(triangle);
        const uvec3 a = vertex_on(on.x), b = vertex_on(on.y), c = vertex_on(on.z);
        bool large = a.z == UNCLIPPED || b.z == UNCLIPPED || c.z == UNCLIPPED;
        Triangle t;
        if (!large) {
            if (!set_up(uintBitsToFloat(a), uintBitsToFloat(b), uintBitsToFloat(c), t)) continue;
            large = t.pixels > SMALL_PIXELS;
        }
        if (large) {
            triangles[i] |= LARGE;
            large_total = 1;
        } else {
            rasterize_small(t);
        }
    }
}

// All threads one triangle after the other.
void rasterize_together(uvec3 first, float iso) {
    for (uint i = 0; i < triangle_total; ++i) {
        if ((triangles[i] & LARGE) == 0) continue;
        const uvec3 on = edges_of(triangles[i] & ~LARGE);
        Polygon polygon;
        polygon.count = 3;
        for (uint corner = 0; corner < 3; ++corner)
            polygon.corners[corner] = project(on[corner], first, iso);
        if (needs_clipping(polygon.corners[0]) || needs_clipping(polygon.corners[1]) ||
            needs_clipping(polygon.corners[2]))
            clip_polygon(polygon);
        for (uint corner = 2; corner < polygon.count; ++corner) {
            Triangle t;
            if (set_up(to_screen(polygon.corners[0]), to_screen(polygon.corners[corner - 1]),
                       to_screen(polygon.corners[corner]), t))
                rasterize_large(t, gl_LocalInvocationIndex, THREADS);
        }
    }
}

void main() {
    const uint thread = gl_LocalInvocationIndex;
    const float iso = frame.surfaces[surface].w;
    uvec3 block;
    if (!my_block(gl_WorkGroupID.z, block)) return;
    const uvec3 first = block * BLOCK;
    const ivec3 left = cells_left(first);
    load_values(first, iso);

    uint layer = 0, layers = BLOCK;
    while (layer < BLOCK) {
        if (thread == 0) vertex_total = triangle_total = large_total = 0;
        barrier();
        if (thread < ROWS) list_vertices(thread, layer, layers, left);
        if (thread >= THREADS - 64) list_triangles(thread - (THREADS - 64), layer, layers, left);
        barrier();
        if (vertex_total > MAX_VERTICES || triangle_total > MAX_TRIANGLES) {
            layers = THIN;
            barrier();
            continue;
        }
        for (eye = 0; eye < frame.counts.x; ++eye) {
            if (eye > 0) {
                if (thread == 0) vertex_total = large_total = 0;
                barrier();
                if (thread < ROWS) list_vertices(thread, layer, layers, left);
                barrier();
            }
            project_vertices(first, iso);
            barrier();
            rasterize_alone();
            barrier();
            if (large_total != 0) rasterize_together(first, iso);
            barrier();
        }
        layer += layers;
    }
}
