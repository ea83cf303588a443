// The occlusion test, finer: a block is in sight if in some square of pixels its box begins before
// the farthest depth drawn there so far. A ray enters a box where it has entered all three pairs of
// parallel faces, and leaves it where it leaves the first. Nearness, 1 / view depth (orthographic:
// less the view depth), of a face's plane is an affine function of the pixel: two multiplications.
// Needs shaders/hidden.glsl.
#include "shaders/ray.glsl"

const uint TEAM = 8;            // threads that look at a block together
const uint SQUARES_ALONG = 12;  // at most, that a block is looked at in
const uint AT_ONCE = 4;         // squares of a thread whose depths are on their way together

bool is_orthographic() { return frame.depth_range.z != 0.0; }

// How far a cell reaches in view depth. A triangle seen edge-on may be drawn at the depth of any of
// its corners, wherever it covers a pixel; all are in one cell.
float cell_depth(uint eye) {
    const mat4 m = frame.eyes[eye].clip_from_voxel;
    const vec3 depth = is_orthographic() ? (frame.depth_range.y - frame.depth_range.x) *
                                               vec3(m[0].z, m[1].z, m[2].z)
                                         : vec3(m[0].w, m[1].w, m[2].w);
    return abs(depth.x) + abs(depth.y) + abs(depth.z);
}

// The nearness of the plane where coordinate `axis` is `at`: a constant, and its growth along x and
// y of normalized device coordinates. `sign`: of at - the eye's coordinate (orthographic: of the
// direction).
vec3 plane_nearness(uint eye, int axis, float at, float sign) {
    const vec3 origin = vec3(frame.eyes[eye].ray_origin[axis], frame.eyes[eye].ray_origin_x[axis],
                             frame.eyes[eye].ray_origin_y[axis]);
    const vec3 direction =
        vec3(frame.eyes[eye].ray_direction[axis], frame.eyes[eye].ray_direction_x[axis],
             frame.eyes[eye].ray_direction_y[axis]);
    if (is_orthographic())
        return (origin - vec3(at, 0.0, 0.0)) / (sign * max(abs(direction.x), 1e-9));
    return direction / (sign * max(abs(at - origin.x), 1e-6));
}

// True for at least one thread of the team if the block is in sight.
bool is_in_sight(uint eye, vec3 low, vec3 high, uint thread) {
    Extent extent;
    project(eye, low, high, extent);
    // Rasterizers round positions to a 256th of a pixel; this is a 32nd or more.
    const vec2 sides = extent.greatest - extent.least;
    low -= 0.5 / max(max(sides.x, sides.y), 1.0);
    high += 0.5 / max(max(sides.x, sides.y), 1.0);
    vec3 enter[3], leave[3];
    for (int axis = 0; axis < 3; ++axis) {
        const float origin = frame.eyes[eye].ray_origin[axis];
        const bool low_first = is_orthographic() ? frame.eyes[eye].ray_direction[axis] > 0.0
                                                 : origin < 0.5 * (low[axis] + high[axis]);
        const float sign = low_first ? 1.0 : -1.0;
        enter[axis] = plane_nearness(eye, axis, low_first ? low[axis] : high[axis], sign);
        leave[axis] = plane_nearness(eye, axis, low_first ? high[axis] : low[axis], sign);
        // Between the two faces the eye has entered already; it may leave through either.
        if (!is_orthographic() && origin > low[axis] && origin < high[axis]) {
            enter[axis] = vec3(1e9, 0.0, 0.0);
            leave[axis] = vec3(-1e9, 0.0, 0.0);
        }
    }
    const float slack = cell_depth(eye);
    const Squares squares = squares_of(extent, SQUARES_ALONG);
    const uvec2 size = squares.end - squares.first + 1;
    const uint offset = pyramid_offset(eye, squares.level);
    // At the most favourable corner of a square.
    const vec2 half_square = vec2(1u << squares.level) / vec2(frame.size.xy);
    for (int axis = 0; axis < 3; ++axis) {
        enter[axis].x += dot(abs(enter[axis].yz), half_square);
        leave[axis].x -= dot(abs(leave[axis].yz), half_square);
    }
    // Each TEAM-th of them, row by row; past the last row, one of it again.
    uvec2 i = uvec2(thread % size.x, thread / size.x);
    const uvec2 stride = uvec2(TEAM % size.x, TEAM / size.x);
    while (i.y < size.y) {
        bool in_sight = false;
        [[unroll]] for (uint n = 0; n < AT_ONCE; ++n) {
            const uvec2 square = squares.first + uvec2(i.x, min(i.y, size.y - 1));
            i += stride;
            if (i.x >= size.x) i += uvec2(-size.x, 1);
            const float drawn = depth_of_square(eye, squares.level, offset, square);
            const vec3 at = vec3(1.0, vec2(2 * square + 1) * half_square - 1.0);
            const float entered =
                min(min(dot(enter[0], at), dot(enter[1], at)), dot(enter[2], at));
            const float left = max(max(dot(leave[0], at), dot(leave[1], at)), dot(leave[2], at));
            const float t = (is_orthographic() ? -entered : 1.0 / entered) - slack;
            const float nearest = reversed_depth(max(t, frame.depth_range.x)) * 1.00001 + 1e-7;
            const bool enters = entered >= left && (entered > 0.0 || is_orthographic());
            in_sight = enters && drawn <= nearest ? true : in_sight;
        }
        if (in_sight) return true;
    }
    return false;
}
