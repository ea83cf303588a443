// The occlusion test once more, finer: eighths of a block, of 4^3 cells, that hold surface and that
// depth already drawn does not hide. All threads of the block's workgroup together.
#include "shaders/frustum.glsl"
#include "shaders/hidden.glsl"

const uint ALL_OCTANTS = 0xff;

// The part of the picture that an octant touches: pixels, and the bits of its nearest depth.
shared int octant_low_x[8], octant_low_y[8], octant_high_x[8], octant_high_y[8];
shared uint octant_nearest[8];
shared uint octants_occupied, octants_visible;

// Octant x + 2 y + 4 z. The cells of a row along x that are in octants of this mask.
uint cells_of_octants(uint octants, uint y, uint z) {
    const uint halves = octants >> (2 * (y >> 2) + 4 * (z >> 2)) & 3u;
    return (halves & 1u) * 0x0fu | (halves >> 1) * 0xf0u;
}

// One corner of one octant. The block is small: none of it is before the near plane.
void widen_octant(uint eye, uint octant, uint corner, uvec3 first) {
    const uvec3 at = uvec3(octant & 1, octant >> 1 & 1, octant >> 2) +
                     uvec3(corner & 1, corner >> 1 & 1, corner >> 2);
    const vec3 position = min(vec3(first + 4 * at), vec3(grid.voxels.xyz) - 1.0);
    Extent extent;
    project(eye, position, extent);
    const ivec2 low = ivec2(floor(extent.least)), high = ivec2(floor(extent.greatest));
    atomicMin(octant_low_x[octant], low.x);
    atomicMin(octant_low_y[octant], low.y);
    atomicMax(octant_high_x[octant], high.x);
    atomicMax(octant_high_y[octant], high.y);
    atomicMax(octant_nearest[octant], floatBitsToUint(max(extent.nearest, 0.0)));
}

// One of the at most 4x4 squares of the depth pyramid that an octant touches.
void look_at_octant(uint eye, uint octant, uint square) {
    const ivec2 last = ivec2(frame.size.xy) - 1;
    const ivec2 low = ivec2(octant_low_x[octant], octant_low_y[octant]);
    const ivec2 high = ivec2(octant_high_x[octant], octant_high_y[octant]);
    if (any(greaterThan(low, last)) || any(lessThan(high, ivec2(0)))) return;  // off the screen
    const Squares squares = squares_of(uvec2(clamp(low, ivec2(0), last)),
                                       uvec2(clamp(high, ivec2(0), last)));
    const uvec2 place = squares.first + uvec2(square & 3u, square >> 2);
    const bool too_large = any(greaterThan(squares.end - squares.first, uvec2(3)));
    if (any(greaterThan(place, squares.end)) && !too_large) return;
    const uint offset = pyramid_offset(eye, squares.level), width = pyramid_size(squares.level).x;
    if (too_large ||
        pyramid[offset + place.x + width * place.y] <= uintBitsToFloat(octant_nearest[octant]))
        atomicOr(octants_visible, 1u << octant);
}

// A bit for each octant to draw. Between barriers: signs must be there, and stay.
uint visible_octants(uvec3 first, ivec3 left) {
    const uint thread = gl_LocalInvocationIndex;
    if (thread == 0) octants_occupied = octants_visible = 0;
    for (uint eye = 0; eye < frame.counts.x; ++eye) {
        if (thread < 8) {
            octant_low_x[thread] = octant_low_y[thread] = 0x7fffffff;
            octant_high_x[thread] = octant_high_y[thread] = -0x7fffffff;
            octant_nearest[thread] = 0;
        }
        barrier();
        if (eye == 0)
            for (uint row = thread; row < ROWS; row += THREADS) {
                if (!has_cells(row % 9, row / 9, left)) continue;
                const uint exist = (1u << clamp(left.x, 0, 8)) - 1;
                const uint cells = occupied_cells(cell_row(row)) & exist;
                const uint halves = (cells & 0x0fu) != 0 ? 1 : 0;
                const uint both = halves | ((cells & 0xf0u) != 0 ? 2 : 0);
                if (both != 0)
                    atomicOr(octants_occupied, both << (2 * (row % 9 >> 2) + 4 * (row / 9 >> 2)));
            }
        for (uint i = thread; i < 64; i += THREADS) widen_octant(eye, i / 8, i % 8, first);
        barrier();
        for (uint i = thread; i < 128; i += THREADS)
            if ((octants_occupied >> i / 16 & 1) != 0) look_at_octant(eye, i / 16, i % 16);
        barrier();
    }
    return octants_visible;
}
