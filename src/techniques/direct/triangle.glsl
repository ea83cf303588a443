// One triangle on the pixel grid, as hardware does it: positions snapped to 1/256 of a pixel, exact
// integer edge functions, the top-left rule, depth as a plane through the positions before they
// were snapped. Needs write_pixel(pixel, depth, front).

// Triangles whose box holds at most so many pixels are left to one thread. At most 4096, so that
// edge functions fit 32 bits.
const uint SMALL_PIXELS = 64;

struct Triangle {
    ivec2 a, b, c;          // 1/256 of a pixel, from the first pixel's centre
    bool front;
    ivec2 low, high;        // pixels on the screen that it may cover
    uint pixels;            // in the box around it, off the screen too
    vec2 reference;         // the depth is that of `a` there
    vec3 plane;             // depth there, and its growth along x and y
    float nearest, farthest;
};

// From pixels and depth. False: it covers no pixel.
bool set_up(vec3 a, vec3 b, vec3 c, out Triangle t) {
    t.a = ivec2(roundEven((a.xy - 0.5) * 256.0));
    t.b = ivec2(roundEven((b.xy - 0.5) * 256.0));
    t.c = ivec2(roundEven((c.xy - 0.5) * 256.0));
    t.low = (min(min(t.a, t.b), t.c) + 255) >> 8;
    t.high = (max(max(t.a, t.b), t.c) - 1) >> 8;
    if (any(lessThan(t.high, t.low))) return false;
    const uvec2 box = uvec2(t.high - t.low + 1);
    t.pixels = box.x * box.y;
    t.low = max(t.low, ivec2(0));
    t.high = min(t.high, ivec2(frame.size.xy) - 1);
    if (any(lessThan(t.high, t.low))) return false;

    // The depth's plane. No depth beyond the vertices': slivers must not stick out.
    const vec3 ab = b - a, ac = c - a;
    const float area = ab.x * ac.y - ab.y * ac.x;
    const vec2 slope = vec2(ab.z * ac.y - ab.y * ac.z, ab.x * ac.z - ab.z * ac.x) / area;
    t.reference = a.xy - 0.5;
    t.plane = vec3(a.z, area == 0.0 ? vec2(0.0) : slope);
    t.nearest = min(max(max(a.z, b.z), c.z), 1.0);
    t.farthest = min(min(a.z, b.z), c.z);
    return true;
}

void turn(inout Triangle t) {
    const ivec2 b = t.b;
    t.b = t.c;
    t.c = b;
}

// Samples on an edge belong to the triangle if it is a left or a top edge.
bool owns_samples(ivec2 along) { return along.y < 0 || (along.y == 0 && along.x > 0); }

void cover(Triangle t, ivec2 pixel) {
    const vec2 from = vec2(pixel) - t.reference;
    const float depth = t.plane.x + t.plane.y * from.x + t.plane.z * from.y;
    write_pixel(pixel, clamp(depth, t.farthest, t.nearest), t.front);
}

// The edge function of the edge from `from` along `along` at a pixel; not negative is inside.
int edge_at(ivec2 from, ivec2 along, ivec2 pixel) {
    const ivec2 p = 256 * pixel - from;
    return along.x * p.y - along.y * p.x - (owns_samples(along) ? 0 : 1);
}

void rasterize_small(Triangle t) {
    const ivec2 ab = t.b - t.a, ac = t.c - t.a;
    const int area = ab.x * ac.y - ab.y * ac.x;
    if (area == 0) return;
    t.front = area > 0;
    if (!t.front) turn(t);
    const ivec2 edge_a = t.b - t.a, edge_b = t.c - t.b, edge_c = t.a - t.c;
    const ivec3 step_x = -256 * ivec3(edge_a.y, edge_b.y, edge_c.y);
    const ivec3 step_y = 256 * ivec3(edge_a.x, edge_b.x, edge_c.x);
    ivec3 row = ivec3(edge_at(t.a, edge_a, t.low), edge_at(t.b, edge_b, t.low),
                      edge_at(t.c, edge_c, t.low));
    for (int y = t.low.y; y <= t.high.y; ++y) {
        ivec3 edges = row;
        for (int x = t.low.x; x <= t.high.x; ++x) {
            if ((edges.x | edges.y | edges.z) >= 0) cover(t, ivec2(x, y));
            edges += step_x;
        }
        row += step_y;
    }
}

// The sign of a cross product, in 64 bits.
int cross_sign(ivec2 u, ivec2 v) {
    int high_a, low_a, high_b, low_b;
    imulExtended(u.x, v.y, high_a, low_a);
    imulExtended(u.y, v.x, high_b, low_b);
    uint borrow;
    const uint low = usubBorrow(uint(low_a), uint(low_b), borrow);
    const int high = high_a - high_b - int(borrow);
    return high < 0 ? -1 : (uint(high) | low) == 0 ? 0 : 1;
}

bool is_inside(ivec2 from, ivec2 to, ivec2 pixel) {
    const int side = cross_sign(to - from, 256 * pixel - from);
    return side > 0 || (side == 0 && owns_samples(to - from));
}

// All threads together.
void rasterize_large(Triangle t, uint thread, uint threads) {
    const int area = cross_sign(t.b - t.a, t.c - t.a);
    if (area == 0) return;
    t.front = area > 0;
    if (!t.front) turn(t);
    const uvec2 box = uvec2(t.high - t.low + 1);
    for (uint i = thread; i < box.x * box.y; i += threads) {
        const ivec2 pixel = t.low + ivec2(i % box.x, i / box.x);
        if (is_inside(t.a, t.b, pixel) && is_inside(t.b, t.c, pixel) &&
            is_inside(t.c, t.a, pixel))
            cover(t, pixel);
    }
}
