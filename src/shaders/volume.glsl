// Voxels and the trilinear field between them. Stored values: 0..255, 0..65535, or floats.
// Most here fetches voxels and interpolates in 32-bit arithmetic: the fixed-point filters of
// samplers (8 bits of weight) are for marching, and for shading 8-bit voxels. Every shader is
// compiled twice: with BRICKED defined for volumes of several bricks, which needs non-uniform
// indexing, and without.

// A brick and the voxel that its texel 0 holds.
struct Brick {
    uint index;
    ivec3 origin;
};

// The brick that holds the cell with this lowest corner, its 8 voxels and an apron of one voxel
// around.
Brick brick_of(ivec3 cell) {
#ifndef BRICKED
    return Brick(0u, ivec3(0));
#else
    const ivec3 where = min(cell / ivec3(grid.brick_cells.xyz), ivec3(grid.bricks.xyz) - 1);
    const ivec3 bricks_along = ivec3(grid.bricks.xyz);
    const int index = where.x + bricks_along.x * (where.y + bricks_along.y * where.z);
    return Brick(uint(index), max(where * ivec3(grid.brick_cells.xyz) - 1, 0));
#endif
}

// Where VOXELS_IN_BUFFER holds a voxel. CPU drivers fetch a word of a buffer many times faster than
// a texel.
uint voxel_index(uvec3 p) { return p.x + grid.voxels.w * p.y + grid.brick_cells.w * p.z; }

// One of the values in a word.
float value_in(uint word, uint place) {
    if (VOXEL_BITS == 8) return float(word >> 8 * place & 0xffu);
    if (VOXEL_BITS == 16) return float(word >> 16 * place & 0xffffu);
    return uintBitsToFloat(word);
}

float load_voxel(ivec3 position) {
    const uint index = voxel_index(uvec3(position)), values = 32 / VOXEL_BITS;
    return value_in(voxels[index / values], index % values);
}

float fetch_texel(uint brick, ivec3 texel) {
#ifdef BRICKED
    return texelFetch(bricks[nonuniformEXT(brick)], texel, 0).r;
#else
    return texelFetch(bricks[0], texel, 0).r;
#endif
}

// What a texel is compared with to know whether its voxel is at least `iso`: halfway between two
// steps, so that nothing needs rounding.
float texel_threshold(float iso) {
    if (VOXEL_BITS == 8) return (ceil(iso) - 0.5) / 255.0;
    if (VOXEL_BITS == 16) return (ceil(iso) - 0.5) / 65535.0;
    return iso;
}

float filter_texels(uint brick, vec3 texel) {
#ifdef BRICKED
    const vec3 size = vec3(textureSize(bricks[nonuniformEXT(brick)], 0));
    return textureLod(sampler3D(bricks[nonuniformEXT(brick)], linear_sampler), texel / size, 0.0).r;
#else
    return textureLod(sampler3D(bricks[0], linear_sampler), texel / vec3(grid.voxels.xyz), 0.0).r;
#endif
}

float voxel(Brick brick, ivec3 position) {
#ifndef BRICKED
    if (VOXEL_FORMAT >= VOXELS_IN_BUFFER) return load_voxel(position);
#endif
    const float texel = fetch_texel(brick.index, position - brick.origin);
    // 8- and 16-bit voxels come as fractions: rounding gives back the very integer, so that ties
    // are exact.
    if (VOXEL_BITS == 8) return round(texel * 255.0);
    if (VOXEL_BITS == 16) return round(texel * 65535.0);
    return texel;
}

ivec3 clamp_to_volume(ivec3 position) {
    return clamp(position, ivec3(0), ivec3(grid.voxels.xyz) - 1);
}

// The lowest corner of the cell that holds p.
ivec3 cell_of(vec3 p) {
    const ivec3 last = max(ivec3(grid.voxels.xyz) - 2, 0);
    return min(to_int(clamp(floor(p), vec3(0.0), vec3(last))), last);  // p may not be a number
}

// Whether all are; voxels that are not finite are stored as what is less than all others.
bool are_finite(float corners[8]) {
    if (VOXEL_BITS != 32) return true;
    float least = corners[0];
    for (int c = 1; c < 8; ++c) least = min(least, corners[c]);
    return least >= grid.range.x;
}

// The 8 corners of a cell, corner c at (c & 1, c >> 1 & 1, c >> 2).
void load_cell(Brick brick, ivec3 cell, out float corners[8]) {
    for (int c = 0; c < 8; ++c) corners[c] = voxel(brick, cell + ivec3(c & 1, c >> 1 & 1, c >> 2));
}

float trilinear(float corners[8], vec3 f) {
    const vec4 x = mix(vec4(corners[0], corners[2], corners[4], corners[6]),
                       vec4(corners[1], corners[3], corners[5], corners[7]), f.x);
    const vec2 y = mix(x.xz, x.yw, f.y);
    return mix(y.x, y.y, f.z);
}

// Through the sampler: fast, with weights of 8 bits. p within the volume.
float sample_filtered(Brick brick, vec3 p) {
    const float scale = VOXEL_BITS == 8 ? 255.0 : VOXEL_BITS == 16 ? 65535.0 : 1.0;
    return scale * filter_texels(brick.index, p - vec3(brick.origin) + 0.5);
}

// The same by fetches.
float sample_exactly(Brick brick, vec3 p) {
    const ivec3 cell = cell_of(p);
    float corners[8];
    load_cell(brick, cell, corners);
    return trilinear(corners, p - vec3(cell));
}

// The gradient in voxel space at a voxel: central differences, one-sided at the volume's border.
// Voxels that are not finite count as the least finite value, so that normals beside them stay
// sane.
vec3 voxel_gradient(Brick brick, ivec3 position) {
    vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
        ivec3 step = ivec3(0);
        step[axis] = 1;
        const ivec3 above = clamp_to_volume(position + step);
        const ivec3 below = clamp_to_volume(position - step);
        const float difference = max(voxel(brick, above), grid.range.x) -
                                 max(voxel(brick, below), grid.range.x);
        gradient[axis] = difference / float(max(above[axis] - below[axis], 1));
    }
    return gradient;
}

// The gradient at f, 0 to 1 along each axis, within a cell of these corners: the voxels' gradients,
// interpolated; the same as central differences of the trilinear field at a distance of one voxel.
// Of the corners and the voxels next to them: 32.
vec3 field_gradient(ivec3 cell, float corners[8], vec3 f) {
    const Brick brick = brick_of(cell);
    const float least = grid.range.x;
    const ivec3 low = max(cell - 1, 0), high = min(cell + 2, ivec3(grid.voxels.xyz) - 1);
    // At a corner: 1 / the distance of the two voxels whose difference is taken.
    const vec3 scale_low = 1.0 / vec3(max(min(cell + 1, high) - low, 1));
    const vec3 scale_high = 1.0 / vec3(max(high - cell, 1));
    for (int c = 0; c < 8; ++c) corners[c] = max(corners[c], least);
    vec3 gradient = vec3(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int i = 0; i < 4; ++i) {
            const ivec2 side = ivec2(i & 1, i >> 1);
            ivec3 position = cell;
            position[u] += side.x;
            position[v] += side.y;
            const int lower = side.x << u | side.y << v, upper = lower | 1 << axis;
            position[axis] = low[axis];
            const float before = max(voxel(brick, position), least);
            position[axis] = high[axis];
            const float after = max(voxel(brick, position), least);
            const vec2 share = mix(1.0 - vec2(f[u], f[v]), vec2(f[u], f[v]), vec2(side));
            const float weight = share.x * share.y;
            gradient[axis] +=
                weight * mix((corners[upper] - before) * scale_low[axis],
                             (after - corners[lower]) * scale_high[axis], f[axis]);
        }
    }
    return gradient;
}

// The same at p.
vec3 field_gradient(vec3 p) {
    const ivec3 cell = cell_of(p);
    float corners[8];
    load_cell(brick_of(cell), cell, corners);
    return field_gradient(cell, corners, p - vec3(cell));
}

// Through the sampler, at the nearest point of the grid of 1/256 voxels that texture units filter
// on: the same in every brick.
float sample_on_grid(Brick brick, vec3 p) {
    return sample_filtered(brick, round(p * 256.0) / 256.0);
}

// The gradient by six such samples in place of 32 voxels. For 8-bit voxels only: of 16-bit ones
// GPUs return no finer differences than whole steps, and floats may not be finite.
vec3 field_gradient_filtered(vec3 p) {
    const Brick brick = brick_of(cell_of(p));
    const vec3 last = vec3(grid.voxels.xyz) - 1.0;
    const vec3 at = round(p * 256.0) / 256.0;
    const vec3 above = min(at + 1.0, last), below = max(at - 1.0, 0.0);
    vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
        vec3 low = at, high = at;
        low[axis] = below[axis];
        high[axis] = above[axis];
        gradient[axis] = sample_filtered(brick, high) - sample_filtered(brick, low);
    }
    return gradient / max(above - below, 1e-6);
}

vec3 world_direction(vec3 direction) {
    return normalize(direction * mat3(frame.world_x.xyz, frame.world_y.xyz, frame.world_z.xyz));
}

// The unit normal in the world on the viewer's side of the surface. `outward` says that the viewer
// is where values are below the isovalue; interpolated gradients can still point a little away from
// the eye near silhouettes, and are turned back just so far that they do not.
vec3 world_normal(vec3 gradient, vec3 direction, bool outward) {
    const vec3 g = outward ? -gradient : gradient;
    vec3 n = g * mat3(frame.normal_x.xyz, frame.normal_y.xyz, frame.normal_z.xyz);
    const vec3 towards = -world_direction(direction);
    // Squares of very large or small floats are none.
    if (VOXEL_BITS == 32) n /= max(max(abs(n.x), abs(n.y)), abs(n.z));
    const float length_squared = dot(n, n);
    if (!(length_squared > 0.0)) return towards;
    const vec3 unit = n * inversesqrt(length_squared);
    const float facing = dot(unit, towards);
    return facing >= 0.0 ? unit : normalize(unit - (facing - 1e-3) * towards);
}
