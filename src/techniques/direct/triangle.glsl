// One triangle on the pixel grid, as hardware does it: positions snapped to 1/256 of a pixel, exact
// integer edge functions, the top-left rule, depth as a plane. Needs write_pixel(eye, pixel, depth,
// front), and SNAPPED. What is computed here is precise, so that a block gets the same bits from
// one thread a triangle and from several.

// Threads that take a large triangle together, and the patch of pixels that they take at once.
const uint TEAM = THREADS < 32 ? THREADS : 32;
const uvec2 TEAM_SIDES = uvec2(8, TEAM / 8);

struct Vertex {
    ivec2 pixel;     // 1/256 of a pixel, from the middle of the origin, a pixel
    vec2 unsnapped;  // pixels, from the middle of the picture's first; the same place if SNAPPED
    float depth;
};

Vertex vertex_at(vec3 screen) {
    const vec2 snapped = roundEven(screen.xy * 256.0);
    return Vertex(ivec2(snapped), SNAPPED ? snapped / 256.0 : screen.xy, screen.z);
}

// Pixels on the screen that a triangle may cover.
struct Box {
    ivec2 low, high;
};

// False: the triangle covers no pixel.
bool find_box(ivec2 origin, ivec2 a, ivec2 b, ivec2 c, out Box box) {
    box.low = max((min(min(a, b), c) + 255) >> 8, -origin);
    box.high = min((max(max(a, b), c) - 1) >> 8, ivec2(frame.size.xy) - 1 - origin);
    return all(lessThanEqual(box.low, box.high));
}

// Depth over pixels, no farther than the corners: slivers must not stick out.
struct Plane {
    vec2 reference, slope;
    float depth;  // at the reference
    float nearest, farthest;
};

vec2 between(Vertex from, Vertex to) {
    return SNAPPED ? vec2(to.pixel - from.pixel) / 256.0 : to.unsnapped - from.unsnapped;
}

Plane plane_through(Vertex a, Vertex b, Vertex c) {
    const vec3 ab = vec3(between(a, b), b.depth - a.depth);
    const vec3 ac = vec3(between(a, c), c.depth - a.depth);
    precise const float area = ab.x * ac.y - ab.y * ac.x;
    precise const vec2 slope = vec2(ab.z * ac.y - ab.y * ac.z, ab.x * ac.z - ab.z * ac.x) / area;
    return Plane(a.unsnapped, area == 0.0 ? vec2(0.0) : slope, a.depth,
                 min(max(max(a.depth, b.depth), c.depth), 1.0),
                 min(min(a.depth, b.depth), c.depth));
}

float depth_at(Plane plane, ivec2 pixel) {
    const vec2 from = vec2(pixel) - plane.reference;
    precise const float depth =
        fma(plane.slope.x, from.x, fma(plane.slope.y, from.y, plane.depth));
    return clamp(depth, plane.farthest, plane.nearest);
}

// Samples on an edge belong to the triangle if it is a left or a top edge.
bool owns_samples(ivec2 along) { return along.y < 0 || (along.y == 0 && along.x > 0); }

// The edge function of the edge from `from` along `along` at a pixel; not negative is inside.
int edge_at(ivec2 from, ivec2 along, ivec2 pixel) {
    const ivec2 p = 256 * pixel - from;
    return along.x * p.y - along.y * p.x - (owns_samples(along) ? 0 : 1);
}

// A triangle's place, in the order in which its edges turn left.
struct Turned {
    ivec2 a, b, c;
    bool front;
};

Turned turned(Vertex a, Vertex b, Vertex c, bool front) {
    return front ? Turned(a.pixel, b.pixel, c.pixel, front)
                 : Turned(a.pixel, c.pixel, b.pixel, front);
}

// The pixels of a box from `start` on, each `step`-th along x and y. The triangle has less than 128
// pixels a side, so that edge functions fit 32 bits.
void rasterize_steps(uint eye, ivec2 origin, Turned t, Plane plane, Box box, ivec2 start,
                     ivec2 step) {
    const ivec2 edge_a = t.b - t.a, edge_b = t.c - t.b, edge_c = t.a - t.c;
    const ivec3 step_x = -256 * step.x * ivec3(edge_a.y, edge_b.y, edge_c.y);
    const ivec3 step_y = 256 * step.y * ivec3(edge_a.x, edge_b.x, edge_c.x);
    const ivec2 first = box.low + start;
    ivec3 row = ivec3(edge_at(t.a, edge_a, first), edge_at(t.b, edge_b, first),
                      edge_at(t.c, edge_c, first));
    for (int y = first.y; y <= box.high.y; y += step.y) {
        ivec3 edges = row;
        for (int x = first.x; x <= box.high.x; x += step.x) {
            const ivec2 pixel = origin + ivec2(x, y);
            if ((edges.x | edges.y | edges.z) >= 0)
                write_pixel(eye, pixel, depth_at(plane, pixel), t.front);
            edges += step_x;
        }
        row += step_y;
    }
}

// By one thread.
void rasterize_small(uint eye, ivec2 origin, Vertex a, Vertex b, Vertex c) {
    Box box;
    if (!find_box(origin, a.pixel, b.pixel, c.pixel, box)) return;
    const ivec2 ab = b.pixel - a.pixel, ac = c.pixel - a.pixel;
    const int area = ab.x * ac.y - ab.y * ac.x;
    if (area == 0) return;
    rasterize_steps(eye, origin, turned(a, b, c, area > 0), plane_through(a, b, c), box, ivec2(0),
                    ivec2(1));
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

// By a team of threads, each its pixel of every patch of TEAM_SIDES; the triangle may have any
// size.
void rasterize_large(uint eye, Vertex a, Vertex b, Vertex c, uint thread) {
    Box box;
    if (!find_box(ivec2(0), a.pixel, b.pixel, c.pixel, box)) return;
    const int area = cross_sign(b.pixel - a.pixel, c.pixel - a.pixel);
    if (area == 0) return;
    const Turned t = turned(a, b, c, area > 0);
    const Plane plane = plane_through(a, b, c);
    const ivec2 start = ivec2(thread % TEAM_SIDES.x, thread / TEAM_SIDES.x);
    const ivec2 sides = max(max(t.a, t.b), t.c) - min(min(t.a, t.b), t.c);
    if (all(lessThan(sides, ivec2(120 * 256)))) {
        rasterize_steps(eye, ivec2(0), t, plane, box, start, ivec2(TEAM_SIDES));
        return;
    }
    for (int y = box.low.y + start.y; y <= box.high.y; y += int(TEAM_SIDES.y))
        for (int x = box.low.x + start.x; x <= box.high.x; x += int(TEAM_SIDES.x)) {
            const ivec2 pixel = ivec2(x, y);
            if (is_inside(t.a, t.b, pixel) && is_inside(t.b, t.c, pixel) &&
                is_inside(t.c, t.a, pixel))
                write_pixel(eye, pixel, depth_at(plane, pixel), t.front);
        }
}
