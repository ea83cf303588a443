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

// A point. Rounding must not make the extent too small: it is a 64th of a pixel wider and 1e-5
// nearer (rasterizers round positions to a 256th). False before the near plane.
bool project(uint eye, vec3 point, out Extent extent) {
    const vec4 clip = frame.eyes[eye].clip_from_voxel * vec4(point, 1.0);
    const vec2 pixel = (0.5 + 0.5 * clip.xy / clip.w) * vec2(frame.size.xy);
    extent = Extent(pixel - 1.0 / 64.0, pixel + 1.0 / 64.0, clip.z / clip.w * 1.00001 + 1e-7);
    return clip.w > 0.0 && clip.z < clip.w;
}

// False if a part of the box lies before the near plane: then it can touch anything.
bool project(uint eye, vec3 low, vec3 high, out Extent extent) {
    extent = Extent(vec2(1e9), vec2(-1e9), 0.0);
    for (uint c = 0; c < 8; ++c) {
        Extent corner;
        if (!project(eye, mix(low, high, vec3(c & 1, c >> 1 & 1, c >> 2)), corner)) return false;
        extent.least = min(extent.least, corner.least);
        extent.greatest = max(extent.greatest, corner.greatest);
        extent.nearest = max(extent.nearest, corner.nearest);
    }
    return true;
}
