// Clipping, for the few triangles that reach before the near plane or so far off the screen that
// 24 bits of 1/256 pixels do not hold them. A cut of an edge is computed from its inner end to its
// outer one: the same in both triangles that share the edge.

// Of normalized device coordinates: pixels from -16384 to the picture's size and 16384 more.
vec2 guard() { return 32768.0 / vec2(frame.size.xy) + 1.0; }

// Not negative: inside of plane 0 (near) to 4.
float plane_distance(vec4 clip, uint plane) {
    const vec2 limit = guard() * clip.w;
    return plane == 0   ? clip.w - clip.z
           : plane == 1 ? limit.x - clip.x
           : plane == 2 ? limit.x + clip.x
           : plane == 3 ? limit.y - clip.y
                        : limit.y + clip.y;
}

bool needs_clipping(vec4 clip) {
    return !(clip.w >= clip.z && clip.w > 0.0 &&
             all(lessThanEqual(abs(clip.xy), guard() * clip.w)));
}

// A convex polygon: a triangle cut by five planes has at most eight corners.
struct Polygon {
    vec4 corners[8];
    uint count;
};

// Not unrolled: forty copies of the cut would double the time to compile the shader.
void clip_polygon(inout Polygon polygon) {
    [[dont_unroll]] for (uint plane = 0; plane < 5; ++plane) {
        const Polygon whole = polygon;
        polygon.count = 0;
        [[dont_unroll]] for (uint i = 0; i < whole.count; ++i) {
            const vec4 from = whole.corners[i], to = whole.corners[(i + 1) % whole.count];
            const float d_from = plane_distance(from, plane), d_to = plane_distance(to, plane);
            if (d_from >= 0.0) polygon.corners[polygon.count++] = from;
            if (d_from >= 0.0 == d_to >= 0.0) continue;
            const bool leaves = d_from >= 0.0;
            const vec4 inner = leaves ? from : to, outer = leaves ? to : from;
            const float d_inner = leaves ? d_from : d_to, d_outer = leaves ? d_to : d_from;
            precise const vec4 cut = inner + d_inner / (d_inner - d_outer) * (outer - inner);
            polygon.corners[polygon.count++] = cut;
        }
    }
}
