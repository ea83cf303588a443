// The occlusion test by a depth pyramid. Needs pyramid[], and shaders/frustum.glsl.
#include "shaders/pyramid.glsl"

// True if depth already drawn is nearer than all of a box, at every pixel that the box can touch.
bool is_hidden(uint eye, Extent extent) {
    const vec2 last = vec2(frame.size.xy) - 1.0;
    const uvec2 low_pixel = uvec2(clamp(floor(extent.least), vec2(0.0), last));
    const uvec2 high_pixel = uvec2(clamp(floor(extent.greatest), vec2(0.0), last));
    // The finest level at which the box covers at most 4x4 squares.
    uint level = 1;
    while (level < PYRAMID_LEVELS &&
           any(greaterThan((high_pixel >> level) - (low_pixel >> level), uvec2(3)))) ++level;
    const uvec2 first = low_pixel >> level, end = high_pixel >> level;
    if (any(greaterThan(end - first, uvec2(15)))) return false;  // larger than a thousand pixels
    const uint offset = pyramid_offset(eye, level), width = pyramid_size(level).x;
    float farthest = 1.0;
    for (uint y = first.y; y <= end.y; ++y)
        for (uint x = first.x; x <= end.x; ++x)
            farthest = min(farthest, pyramid[offset + x + width * y]);
    return farthest > extent.nearest;
}
