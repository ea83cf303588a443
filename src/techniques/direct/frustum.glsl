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
