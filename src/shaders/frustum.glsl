// What an eye can see of a box in voxel space.

bool is_beyond(vec4 plane, vec3 low, vec3 high) {
    const vec3 nearest = mix(low, high, greaterThan(plane.xyz, vec3(0.0)));
    return dot(plane.xyz, nearest) + plane.w < 0.0;
}

// True unless the whole box lies outside one plane of the eye's frustum or of the clip planes.
bool in_frustum(uint eye, vec3 low, vec3 high) {
    for (uint i = 0; i < 6; ++i)
        if (is_beyond(frame.eyes[eye].planes[i], low, high)) return false;
    for (uint i = 0; i < frame.counts.y; ++i)
        if (is_beyond(frame.clips[i], low, high)) return false;
    return true;
}

// What a box can touch of an eye's picture: pixels, and depth.
struct Extent {
    vec2 least, greatest;
    float nearest;
};

// False if a part of the box may lie before the near plane: then it can touch anything. At a place
// d from the middle m, x / w of clip space differs from the middle's by (dx - mx / mw * dw) /
// (mw + dw). Rounding must not make the extent too small: it is a 64th of a pixel wider and 1e-5
// nearer (rasterizers round positions to a 256th).
bool project(uint eye, vec3 low, vec3 high, out Extent extent) {
    const mat4 m = frame.eyes[eye].clip_from_voxel;
    const vec3 half_sides = 0.5 * (high - low);
    const vec4 clip = m * vec4(low + half_sides, 1.0);
    const vec3 middle = clip.xyz / clip.w;
    vec3 reach = vec3(0.0);
    float least_w = clip.w;
    for (int axis = 0; axis < 3; ++axis) {
        reach += half_sides[axis] * abs(m[axis].xyz - middle * m[axis].w);
        least_w -= half_sides[axis] * abs(m[axis].w);
    }
    reach /= least_w;
    const vec2 half_size = 0.5 * vec2(frame.size.xy);
    const vec2 pixel = (middle.xy + 1.0) * half_size, radius = reach.xy * half_size + 1.0 / 64.0;
    extent = Extent(pixel - radius, pixel + radius, (middle.z + reach.z) * 1.00001 + 1e-7);
    return least_w > 0.0 && middle.z + reach.z < 1.0;
}
