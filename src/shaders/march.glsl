// Min-max-octree ray marching: the paper's reference (Kreskowski 2022, section 4, "Ray-marching
// Reference" and "Software"): steps of half a cell in blocks that the isovalue crosses, then three
// bisections. EXACT solves each cell's cubic instead.

layout(constant_id = 1) const bool EXACT = false;
// Sample through the texture unit, as in the paper; CPU drivers round its results to 8 bits for
// 8-bit voxels, so there voxels are fetched and interpolated.
layout(constant_id = 2) const bool FILTERED = true;

float field_at(Brick brick, vec3 p) {
    return FILTERED ? sample_filtered(brick, p) : sample_exactly(brick, p);
}

struct March {
    Ray ray;
    vec3 inverse;   // 1 / direction
    float iso;
    float nudge;    // a step over a boundary, as a difference of t
    bool known;     // is `inside` known yet?
    bool inside;    // which side of the surface the ray is on
    float t;        // how far the ray has come; the hit, once there is one
};

// The ray is now known to be on this side; true when that means that it has crossed the surface.
bool crossed_to(inout March march, bool inside) {
    const bool crossed = march.known && march.inside != inside;
    march.known = true;
    march.inside = inside;
    return crossed;
}

float exit_of(March march, vec3 low, vec3 high) {
    const vec3 far_sides = mix(low, high, greaterThan(march.ray.direction, vec3(0.0)));
    const vec3 t = (far_sides - march.ray.origin) * march.inverse;
    return min(min(t.x, t.y), t.z);
}

vec3 position_at(March march, float t) {
    const vec3 last = vec3(grid.voxels.xyz) - 1.0;
    return clamp(march.ray.origin + t * march.ray.direction, vec3(0.0), last);
}

// The paper's way through a block that the isovalue crosses.
bool step_through(inout March march, ivec3 block, float end) {
    const Brick brick = brick_of(block * int(BLOCK));
    const float step = 0.5 / length(march.ray.direction);
    float before = march.t;
    for (float t = march.t; ; t = min(t + step, end)) {
        const bool was_inside = march.inside;
        if (crossed_to(march, field_at(brick, position_at(march, t)) >= march.iso)) {
            float a = before, b = t;
            for (int i = 0; i < 3; ++i) {
                const float middle = 0.5 * (a + b);
                const bool inside = field_at(brick, position_at(march, middle)) >= march.iso;
                if (inside == was_inside) a = middle;
                else b = middle;
            }
            march.t = 0.5 * (a + b);
            return true;
        }
        if (t >= end) return false;
        before = t;
    }
}

// The exact way: cell after cell, each solved as a cubic.
bool solve_through(inout March march, ivec3 block, float end) {
    const Brick brick = brick_of(block * int(BLOCK));
    const ivec3 low = block * int(BLOCK);
    const ivec3 high = min(low + int(BLOCK), ivec3(grid.voxels.xyz) - 1) - 1;
    const ivec3 forward = ivec3(sign(march.ray.direction));
    ivec3 cell = clamp(ivec3(floor(position_at(march, march.t + march.nudge))), low, high);
    for (int i = 0; i < 32; ++i) {
        const float leave = min(max(exit_of(march, vec3(cell), vec3(cell + 1)), march.t), end);
        float corners[8];
        load_cell(brick, cell, corners);
        float least = corners[0], greatest = corners[0];
        for (int c = 1; c < 8; ++c) {
            least = min(least, corners[c]);
            greatest = max(greatest, corners[c]);
        }
        // Between voxels of which some are not finite is nothing.
        if (!crosses(vec2(least, greatest), march.iso) || !are_finite(corners)) {
            if (crossed_to(march, least >= march.iso)) return true;
        } else {
            const vec3 from = march.ray.origin + march.t * march.ray.direction - vec3(cell);
            const vec3 to = march.ray.origin + leave * march.ray.direction - vec3(cell);
            const CellLine line = cell_line(corners, from, to, march.iso);
            if (!march.known) crossed_to(march, line.cubic.x >= 0.0);
            float s;
            if (first_crossing(line, march.inside, s)) {
                march.t = mix(march.t, leave, s);
                return true;
            }
        }
        march.t = leave;
        // Go on to the neighbour behind the face through which the ray leaves.
        const vec3 t = (vec3(cell + max(forward, 0)) - march.ray.origin) * march.inverse;
        const int axis = t.x <= t.y && t.x <= t.z ? 0 : t.y <= t.z ? 1 : 2;
        cell[axis] += forward[axis];
        if (leave >= end || cell[axis] < low[axis] || cell[axis] > high[axis]) return false;
    }
    return false;
}

// From where the ray enters the volume, or what clip planes leave of it, to `end`.
March begin_march(Ray ray, float iso, out float end) {
    // An axis that the ray does not move along gets the least movement that still divides.
    const vec3 least = vec3(1e-20 + 1e-9 * length(ray.direction));
    ray.direction = mix(ray.direction, least, lessThan(abs(ray.direction), least));
    March march = March(ray, 1.0 / ray.direction, iso, 0.0, false, false, 0.0);
    const float all_sides = float(grid.voxels.x + grid.voxels.y + grid.voxels.z);
    march.nudge = (1e-4 + 2e-7 * all_sides) / length(ray.direction);

    const vec3 last = vec3(grid.voxels.xyz) - 1.0;
    const vec3 a = -ray.origin * march.inverse, b = (last - ray.origin) * march.inverse;
    const vec3 enter = min(a, b), leave = max(a, b);
    march.t = max(max(max(enter.x, enter.y), enter.z), frame.depth_range.x);
    end = min(min(min(leave.x, leave.y), leave.z), frame.depth_range.y);
    for (uint i = 0; i < frame.counts.y; ++i) {
        const float across = dot(frame.clips[i].xyz, ray.direction);
        const float t = -(dot(frame.clips[i].xyz, ray.origin) + frame.clips[i].w) / across;
        if (across > 0.0) march.t = max(march.t, t);
        else end = min(end, t);
    }
    return march;
}

// Levels of the min-max pyramid, every second one, that are looked at together: as a ray waits for
// what it fetches, that takes no longer than one, and there are none to climb up and down.
const uint LEVELS = 3;

// The largest of their nodes around a point that the isovalue does not cross, and which side of the
// surface that is on; or the block.
struct Node {
    uint level;
    uvec3 place;
    bool crossed, inside;
};

Node node_around(vec3 p, float iso) {
    Node node;
    [[unroll]] for (uint i = 0; i < LEVELS; ++i) {
        const uint level = min(2 * i, grid.bricks.w - 1);
        const uvec3 place = min(uvec3(p) >> 3 + level, grid.levels[level].xyz - 1);
        const vec2 range = node_range(node_index(level, place));
        const bool crossed = crosses(range, iso);
        if (i == 0 || !crossed) node = Node(level, place, crossed, range.x >= iso);
    }
    return node;
}

// Where the ray leaves a node that it is in, or its way ends, as t.
float leave_node(March march, Node node, float end) {
    const uint shift = 3 + node.level;
    const vec3 low = vec3(node.place << shift), high = vec3((node.place + 1) << shift);
    return min(max(exit_of(march, low, high), march.t + march.nudge), end);
}

// The first crossing of the isovalue along the ray, as t; false if there is none.
bool first_hit(Ray ray, float iso, out float hit) {
    float end;
    March march = begin_march(ray, iso, end);
    for (int i = 0; i < 65536 && march.t < end; ++i) {
        const Node node = node_around(position_at(march, march.t + march.nudge), iso);
        const float leave = leave_node(march, node, end);
        if (!node.crossed ? crossed_to(march, node.inside)
            : EXACT       ? solve_through(march, ivec3(node.place), leave)
                          : step_through(march, ivec3(node.place), leave)) {
            hit = march.t;
            return march.t < end;
        }
        march.t = leave;
    }
    return false;
}

// The first surface along the ray, as t, and its number; false if there is none.
bool nearest_hit(Ray ray, out float nearest, out uint number) {
    bool found = false;
    nearest = 0.0;
    number = 0;
    for (uint i = 0; i < frame.size.z; ++i) {
        float t;
        if (!first_hit(ray, frame.surfaces[i].w, t) || (found && t >= nearest)) continue;
        found = true;
        nearest = t;
        number = i;
    }
    return found;
}
