// The occlusion test by a depth pyramid. Needs pyramid[], and shaders/frustum.glsl.
#include "shaders/pyramid.glsl"

// The squares of the pyramid that an extent touches: at the finest level at which they are at most
// `most` along x and y, or else at the coarsest.
struct Squares {
    uint level;
    uvec2 first, end;  // both belong to it
};

Squares squares_of(Extent extent, uint most) {
    const vec2 last = vec2(frame.size.xy) - 1.0;
    const uvec2 low_pixel = to_uint(clamp(floor(extent.least), vec2(0.0), last));
    const uvec2 high_pixel = to_uint(clamp(floor(extent.greatest), vec2(0.0), last));
    // At a level where so many would do if the extent began with a square, or at the next one.
    const uvec2 sides = high_pixel - low_pixel;
    uint level = uint(clamp(findMSB(max(sides.x, sides.y) / most) + 1, 1, int(PYRAMID_LEVELS)));
    if (level < PYRAMID_LEVELS &&
        any(greaterThanEqual((high_pixel >> level) - (low_pixel >> level), uvec2(most))))
        ++level;
    return Squares(level, low_pixel >> level, high_pixel >> level);
}

// `first`: the first one of the square's level in the pyramid. SURFACES: where there is no surface,
// the farthest one around.
float depth_of_square(uint eye, uint level, uint first, uvec2 square) {
    float depth = pyramid[first + square.x + pyramid_size(level).x * square.y];
#ifdef SURFACES
    while (depth == 0.0 && level < PYRAMID_LEVELS) {
        square >>= 1u;
        ++level;
        depth = pyramid[pyramid_offset(eye, level) + square.x + pyramid_size(level).x * square.y];
    }
#endif
    return depth;
}

// True if depth already drawn is nearer than all of a box, at every pixel that the box can touch.
// Boxes that touch more than `most` of the coarsest squares along x or y are not looked into.
bool is_hidden(uint eye, Extent extent, uint most) {
    const Squares squares = squares_of(extent, 4);
    if (any(greaterThanEqual(squares.end - squares.first, uvec2(most)))) return false;
    const uint offset = pyramid_offset(eye, squares.level);
    float farthest = 1.0;
    for (uint y = squares.first.y; y <= squares.end.y; ++y)
        for (uint x = squares.first.x; x <= squares.end.x; x += 4)
            [[unroll]] for (uint n = 0; n < 4; ++n) {  // all four depths on their way together
                const uvec2 square = uvec2(min(x + n, squares.end.x), y);
                farthest = min(farthest, depth_of_square(eye, squares.level, offset, square));
            }
    return farthest > extent.nearest;
}

// The same for what is small: at most 2x2 squares, all on their way together.
bool is_small_hidden(uint eye, Extent extent) {
    const Squares squares = squares_of(extent, 2);
    if (any(greaterThan(squares.end - squares.first, uvec2(1)))) return false;
    const uint offset = pyramid_offset(eye, squares.level);
    float farthest = 1.0;
    [[unroll]] for (uint n = 0; n < 4; ++n) {
        const uvec2 square = min(squares.first + uvec2(n & 1, n >> 1), squares.end);
        farthest = min(farthest, depth_of_square(eye, squares.level, offset, square));
    }
    return farthest > extent.nearest;
}
