#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Workgroup: 16x16 pixels of one eye. Thread: four of them, whose depths it fetches at once. Out:
// their colour and distance, from the technique's depth: unproject, move the hit onto the
// trilinear surface, take the gradient, shade. One pass for all techniques.
#include "shaders/scene.glsl"
#include "shaders/volume.glsl"
#include "shaders/ray.glsl"
#include "shaders/cell_root.glsl"
#include "shaders/shading.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 1) const bool WRITE_COLOR = true;     // and refine the hit
layout(constant_id = 2) const bool WRITE_DISTANCE = false;
layout(constant_id = 3) const bool MARK_VISIBLE = false;   // for the next frame's culling
layout(constant_id = 4) const bool FILTERED = false;       // sample through the texture unit
layout(constant_id = 5) const bool CLEARED = false;        // the background is there before

layout(set = 1, binding = 0) uniform texture2DArray depth;
layout(set = 1, binding = 1) uniform utexture2DArray surface_numbers;
layout(set = 1, binding = 2, rgba8) writeonly uniform image2DArray color;
layout(set = 1, binding = 3, r32f) writeonly uniform image2DArray distances;
#define VISIBLE_BLOCKS_BINDING 4
#include "shaders/visible_blocks.glsl"

// As Shading in renderer.h.
const uint GOOCH = 0, PHONG = 1, NORMALS = 2, DEPTH = 3, BLOCKS = 4;

// The ray's way through a cell, as t from and to.
vec2 span_in_cell(Ray ray, ivec3 cell) {
    const vec3 low = (vec3(cell) - ray.origin) / ray.direction;
    const vec3 high = (vec3(cell + 1) - ray.origin) / ray.direction;
    const vec3 enter = min(low, high), leave = max(low, high);
    return vec2(max(max(enter.x, enter.y), enter.z), min(min(leave.x, leave.y), leave.z));
}

// A point on the surface: where along the ray, and whether the ray enters there (values rise); the
// cell there, unless FILTERED.
struct Hit {
    float t;
    bool entering, refined;
    ivec3 cell;
    float corners[8];
};

Hit crossing_in_cell(Ray ray, ivec3 cell, float t, float iso) {
    Hit hit;
    hit.t = t;
    hit.entering = true;
    hit.refined = false;
    hit.cell = cell;
    load_cell(brick_of(cell), cell, hit.corners);
    const vec2 span = span_in_cell(ray, cell);
    if (!(span.x < span.y) || !are_finite(hit.corners)) return hit;
    const vec3 from = ray.origin + span.x * ray.direction - vec3(cell);
    const vec3 to = ray.origin + span.y * ray.direction - vec3(cell);
    const CellLine line = cell_line(hit.corners, from, to, iso);
    float s;
    if (!nearest_crossing(line, (t - span.x) / (span.y - span.x), s)) return hit;
    hit.t = mix(span.x, span.y, s);
    hit.entering = slope_at(line.cubic, s) > 0.0;
    hit.refined = true;
    return hit;
}

// The trilinear surface nearest to t along the ray, in the cell there or else in the cells before
// and after it; t itself where the ray misses the trilinear surface (at silhouettes).
Hit refine_hit(Ray ray, float t, float iso) {
    const ivec3 cell = cell_of(ray.origin + t * ray.direction);
    Hit best = crossing_in_cell(ray, cell, t, iso);
    if (best.refined) return best;
    const float voxel_step = 1.0 / length(ray.direction);  // one voxel, as a difference of t
    const vec2 span = span_in_cell(ray, cell);
    float nearest = voxel_step;
    for (int side = 0; side < 2; ++side) {
        const float beyond = side == 0 ? span.x - 0.01 * voxel_step : span.y + 0.01 * voxel_step;
        const ivec3 neighbour = cell_of(ray.origin + beyond * ray.direction);
        if (neighbour == cell) continue;
        const Hit hit = crossing_in_cell(ray, neighbour, t, iso);
        if (!hit.refined || abs(hit.t - t) >= nearest) continue;
        best = hit;
        nearest = abs(hit.t - t);
    }
    return best;
}

// The same through the sampler: false position between points half a voxel, or else one voxel,
// before and behind t. Exact to about a 256th of a voxel.
Hit refine_hit_filtered(Ray ray, float t, float iso) {
    const float voxel_step = 1.0 / length(ray.direction);
    const vec3 last = vec3(grid.voxels.xyz) - 1.0;
    const Brick brick = brick_of(cell_of(ray.origin + t * ray.direction));
    float a = t, b = t, value_a = 0.0, value_b = 0.0;
    for (int i = 1; i <= 2 && (value_a < 0.0) == (value_b < 0.0); ++i) {
        a = t - 0.5 * float(i) * voxel_step;
        b = t + 0.5 * float(i) * voxel_step;
        const vec3 at_a = ray.origin + a * ray.direction, at_b = ray.origin + b * ray.direction;
        value_a = sample_on_grid(brick, clamp(at_a, vec3(0.0), last)) - iso;
        value_b = sample_on_grid(brick, clamp(at_b, vec3(0.0), last)) - iso;
    }
    Hit hit;
    hit.t = t;
    hit.entering = value_b > value_a;
    hit.refined = (value_a < 0.0) != (value_b < 0.0);
    if (!hit.refined) return hit;
    const float t1 = (a * value_b - b * value_a) / (value_b - value_a);
    const float value = sample_on_grid(brick, ray.origin + t1 * ray.direction) - iso;
    const bool before = (value < 0.0) == (value_a < 0.0);
    a = before ? t1 : a;
    value_a = before ? value : value_a;
    b = before ? b : t1;
    value_b = before ? value_b : value;
    hit.t = (a * value_b - b * value_a) / (value_b - value_a);
    return hit;
}

// A colour for each block, well apart from its neighbours'.
vec3 block_color(ivec3 block) {
    const uvec3 mixed = uvec3(block) * uvec3(0x9e3779b1u, 0x85ebca77u, 0xc2b2ae3du);
    uint h = mixed.x ^ mixed.y ^ mixed.z;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h ^= h >> 13;
    return 0.3 + 0.6 * vec3(h & 255u, h >> 8 & 255u, h >> 16 & 255u) / 255.0;
}

vec4 shade(Ray ray, Hit hit, vec3 surface_color) {
    const vec3 p = ray.origin + hit.t * ray.direction;
    const vec3 direction = world_direction(ray.direction);
    if (frame.size.w == DEPTH) {
        const float near = frame.depth_range.x, far = frame.depth_range.y;
        return vec4(vec3(mix(0.95, 0.05, clamp((hit.t - near) / (far - near), 0.0, 1.0))), 1.0);
    }
    const vec3 gradient = FILTERED ? field_gradient_filtered(p)
                                   : field_gradient(hit.cell, hit.corners, p - vec3(hit.cell));
    const bool outward = hit.refined ? hit.entering : dot(gradient, ray.direction) > 0.0;
    const vec3 normal = world_normal(gradient, ray.direction, outward);
    if (frame.size.w == NORMALS) return vec4(0.5 + 0.5 * normal, 1.0);
    if (frame.size.w == BLOCKS)
        return vec4(phong(block_color(cell_of(p) / int(BLOCK)), normal, direction), 1.0);
    if (frame.size.w == PHONG) return vec4(phong(surface_color, normal, direction), 1.0);
    return vec4(gooch(surface_color, normal, direction), 1.0);
}

void shade_pixel(ivec3 pixel, float z) {
    vec4 result = frame.background;
    float t = uintBitsToFloat(0x7f800000u);  // infinity
    if (z > 0.0) {
        const Ray ray = pixel_ray(pixel.z, vec2(pixel.xy) + 0.5);
        t = view_depth(z);
        if (MARK_VISIBLE) mark_visible(cell_of(ray.origin + t * ray.direction));
        if (WRITE_COLOR) {
            const uint number = frame.size.z > 1 ? texelFetch(surface_numbers, pixel, 0).r : 0;
            const float iso = frame.surfaces[number].w;
            const Hit hit = FILTERED ? refine_hit_filtered(ray, t, iso) : refine_hit(ray, t, iso);
            t = hit.t;
            result = shade(ray, hit, frame.surfaces[number].rgb);
        }
    }
    if (WRITE_COLOR && (z > 0.0 || !CLEARED)) imageStore(color, pixel, result);
    if (WRITE_DISTANCE) imageStore(distances, pixel, vec4(t));
}

void main() {
    const ivec2 first = ivec2(16 * gl_WorkGroupID.xy + gl_LocalInvocationID.xy);
    const ivec2 last = ivec2(frame.size.xy) - 1;
    const int eye = int(gl_GlobalInvocationID.z);
    vec4 z;
    for (int i = 0; i < 4; ++i)
        z[i] = texelFetch(depth, ivec3(min(first + 8 * ivec2(i & 1, i >> 1), last), eye), 0).r;
    [[dont_unroll]] for (int i = 0; i < 4; ++i) {
        const ivec2 pixel = first + 8 * ivec2(i & 1, i >> 1);
        if (all(lessThanEqual(pixel, last))) shade_pixel(ivec3(pixel, eye), z[i]);
    }
}
