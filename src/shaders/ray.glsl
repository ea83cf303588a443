// Rays of pixels, and what depth means along them.

struct Ray {
    vec3 origin, direction;  // voxel space; a step of 1 is one unit of view depth in the world
};

Ray pixel_ray(vec2 pixel) {
    const vec2 ndc = 2.0 * pixel / vec2(frame.size.xy) - 1.0;
    const vec4 origin = frame.ray_origin + ndc.x * frame.ray_origin_x + ndc.y * frame.ray_origin_y;
    const vec4 direction =
        frame.ray_direction + ndc.x * frame.ray_direction_x + ndc.y * frame.ray_direction_y;
    return Ray(origin.xyz, direction.xyz);
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
