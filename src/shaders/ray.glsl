// Rays of pixels, and what depth means along them.

struct Ray {
    vec3 origin, direction;  // voxel space; a step of 1 is one unit of view depth in the world
};

vec2 ndc_of(vec2 pixel) { return 2.0 * pixel / vec2(frame.size.xy) - 1.0; }

Ray pixel_ray(uint eye, vec2 pixel) {
    const vec2 ndc = ndc_of(pixel);
    const vec4 origin = frame.eyes[eye].ray_origin + ndc.x * frame.eyes[eye].ray_origin_x +
                        ndc.y * frame.eyes[eye].ray_origin_y;
    const vec4 direction = frame.eyes[eye].ray_direction + ndc.x * frame.eyes[eye].ray_direction_x +
                           ndc.y * frame.eyes[eye].ray_direction_y;
    return Ray(origin.xyz, direction.xyz);
}

// Whether no clip plane cuts off what is seen at a pixel (its middle is at x.5) in this depth.
bool is_kept(uint eye, vec2 pixel, float depth) {
    for (uint i = 0; i < frame.counts.y; ++i)
        if (dot(frame.eyes[eye].clips[i], vec4(ndc_of(pixel), depth, 1.0)) < 0.0) return false;
    return true;
}

// Reversed depth (1 near, 0 far) to view depth in world units, and back.
float view_depth(float depth) {
    const float near = frame.depth_range.x, far = frame.depth_range.y;
    if (frame.depth_range.z != 0.0) return far - depth * (far - near);
    return near * far / (depth * (far - near) + near);
}

float reversed_depth(float t) {
    const float near = frame.depth_range.x, far = frame.depth_range.y;
    if (frame.depth_range.z != 0.0) return (far - t) / (far - near);
    return (near * far / t - near) / (far - near);
}
