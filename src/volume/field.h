// SPDX-License-Identifier: MIT
// The formulas behind procedural volumes, once, for C++ and GLSL: single precision in the common
// subset of both, with nothing but + - * /, floor, sqrt, min, max and integers, so that CPU and GPU
// agree to 1e-6 (Vulkan's own sin and cos may err by 5e-4). Positions are in [-1, 1]^3 for the
// longest side.
#ifndef ISORAST_VOLUME_FIELD_H
#define ISORAST_VOLUME_FIELD_H

#ifdef __cplusplus
#include <isorast/volume.h>

#include <algorithm>
#include <cmath>

#define FIELD_FUNCTION inline
#define FIELD_PRECISE
namespace isorast::field {
using uint = uint32_t;
using std::floor;
using std::max;
using std::min;
using std::sqrt;
#else
#define FIELD_FUNCTION
#define FIELD_PRECISE precise  // no fused multiply-add and no reordering, as on the CPU
#endif

const uint FIELD_SPHERE = 0u, FIELD_TORUS = 1u, FIELD_GYROID = 2u, FIELD_MARSCHNER_LOBB = 3u;
const uint FIELD_NOISE = 4u, FIELD_CORAL = 5u;
const uint FIELD_HEAD = 6u, FIELD_VESSELS = 7u, FIELD_BONE = 8u;

const float FIELD_PI = 3.14159265358979f;

// Where in its one period of time a formula is. The host computes all three, so that CPU and GPU
// get the same bits; all are 0 in a volume without time, and then change no formula by a bit.
struct FieldMotion {
    float phase;  // 0 to 2 pi
    float swing;  // sin(phase)
    float swell;  // 1 - cos(phase), 0 to 2
};

// sin(r) for |r| <= pi/2: the minimax polynomial of degree 9, absolute error 5e-9 before rounding.
FIELD_FUNCTION float field_sine_core(float r) {
    FIELD_PRECISE float s = r * r;
    FIELD_PRECISE float p = 2.6000547678828055e-6f * s - 1.980661520134723e-4f;
    p = p * s + 8.33301729156212e-3f;
    p = p * s - 1.6666657096504692e-1f;
    FIELD_PRECISE float sine = r + r * s * p;
    return sine;
}

// x - turns * pi with pi in three parts, the first two so short that their products are exact (Cody
// & Waite).
FIELD_FUNCTION float field_reduce(float x, float turns) {
    FIELD_PRECISE float r = x - turns * 3.140625f;
    r = r - turns * 9.67502593994140625e-4f;
    r = r - turns * 1.509957990978376e-7f;
    return r;
}

// Absolute error at most 2e-7 for |x| <= 100.
FIELD_FUNCTION float field_sin(float x) {
    FIELD_PRECISE float turns = floor(x * (1.0f / FIELD_PI) + 0.5f);
    float sine = field_sine_core(field_reduce(x, turns));
    return (uint(int(turns)) & 1u) != 0u ? -sine : sine;
}

// Not field_sin(x + pi/2): that sum would round off what the reduction is careful to keep.
FIELD_FUNCTION float field_cos(float x) {
    FIELD_PRECISE float turns = floor(x * (1.0f / FIELD_PI));
    float sine = field_sine_core(field_reduce(x, turns + 0.5f));
    return (uint(int(turns)) & 1u) != 0u ? sine : -sine;
}

FIELD_FUNCTION float field_length(float x, float y, float z) {
    FIELD_PRECISE float squares = x * x + y * y + z * z;
    return sqrt(squares);
}

// Solids breathe: grow by a ninth and shrink again, and stay within the cube.
FIELD_FUNCTION float field_breath(FieldMotion m) {
    FIELD_PRECISE float scale = 1.0f - 0.05f * m.swell;
    return scale;
}

FIELD_FUNCTION float field_sphere(FieldMotion m, float x, float y, float z) {
    FIELD_PRECISE float value = 1.0f - field_breath(m) * field_length(x, y, z);
    return value;
}

FIELD_FUNCTION float field_torus(FieldMotion m, float x, float y, float z) {
    FIELD_PRECISE float s = field_breath(m), a = s * x, b = s * y, c = s * z;
    return 0.25f - field_length(field_length(a, b, 0.0f) - 0.6f, c, 0.0f);
}

// Waves in three directions, -1.5 to 1.5; arguments in radians.
FIELD_FUNCTION float field_waves(float a, float b, float c) {
    FIELD_PRECISE float sum =
        field_sin(a) * field_cos(b) + field_sin(b) * field_cos(c) + field_sin(c) * field_cos(a);
    return sum;
}

// Waves travel: along x.
FIELD_FUNCTION float field_gyroid(FieldMotion m, float x, float y, float z) {
    FIELD_PRECISE float a = 2.0f * FIELD_PI * x + m.phase;
    FIELD_PRECISE float b = 2.0f * FIELD_PI * y, c = 2.0f * FIELD_PI * z;
    return field_waves(a, b, c);
}

// Marschner & Lobb, "An evaluation of reconstruction filters for volume rendering", 1994,
// section 5. Its ripples run outwards.
FIELD_FUNCTION float field_marschner_lobb(FieldMotion m, float x, float y, float z) {
    const float frequency = 6.0f, alpha = 0.25f;
    FIELD_PRECISE float phase =
        2.0f * FIELD_PI * frequency * field_cos(FIELD_PI / 2.0f * field_length(x, y, 0.0f)) +
        m.phase;
    FIELD_PRECISE float sum =
        1.0f - field_sin(FIELD_PI / 2.0f * z) + alpha * (1.0f + field_cos(phase));
    return sum * (1.0f / (2.0f * (1.0f + alpha)));
}

// A value in [0, 1) with 24 random bits for a point of the lattice.
FIELD_FUNCTION float field_lattice(int x, int y, int z, uint seed) {
    uint h =
        uint(x) * 0x9e3779b1u ^ uint(y) * 0x85ebca77u ^ uint(z) * 0xc2b2ae3du ^ seed * 0x27d4eb2fu;
    h = (h ^ (h >> 16)) * 0x7feb352du;
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    h = h ^ (h >> 16);
    return float(h >> 8) * (1.0f / 16777216.0f);
}

FIELD_FUNCTION float field_mix(float a, float b, float t) {
    FIELD_PRECISE float mixed = a + (b - a) * t;
    return mixed;
}

FIELD_FUNCTION float field_smoothstep(float t) {
    FIELD_PRECISE float smoothed = t * t * (3.0f - 2.0f * t);
    return smoothed;
}

// The lattice's values, interpolated along x at whole y and z.
FIELD_FUNCTION float field_lattice_row(int x, int y, int z, float t, uint seed) {
    return field_mix(field_lattice(x, y, z, seed), field_lattice(x + 1, y, z, seed), t);
}

FIELD_FUNCTION float field_value_noise(float x, float y, float z, uint seed) {
    int i = int(floor(x)), j = int(floor(y)), k = int(floor(z));
    float u = field_smoothstep(x - floor(x)), v = field_smoothstep(y - floor(y));
    float near =
        field_mix(field_lattice_row(i, j, k, u, seed), field_lattice_row(i, j + 1, k, u, seed), v);
    float far = field_mix(field_lattice_row(i, j, k + 1, u, seed),
                          field_lattice_row(i, j + 1, k + 1, u, seed), v);
    return field_mix(near, far, field_smoothstep(z - floor(z)));
}

// Octaves of value noise: each has twice the frequency and 0.62 of the amplitude of the one before.
// In time each goes round a circle of one lattice cell's radius, every other one the other way.
FIELD_FUNCTION float field_noise(FieldMotion m, uint octaves, uint seed, float x, float y,
                                 float z) {
    FIELD_PRECISE float amplitude = 0.5f, frequency = 6.0f, sum = 0.0f;
    for (uint octave = 0u; octave < octaves; ++octave) {
        FIELD_PRECISE float shift = float(octave) * 17.3f;  // so that the lattices do not coincide
        FIELD_PRECISE float swing = (octave & 1u) == 0u ? m.swing : -m.swing;
        FIELD_PRECISE float a = (x + 1.0f) * 0.5f * frequency + shift + swing;
        FIELD_PRECISE float b = (y + 1.0f) * 0.5f * frequency + shift + m.swell;
        FIELD_PRECISE float c = (z + 1.0f) * 0.5f * frequency + shift;
        sum = sum + amplitude * (field_value_noise(a, b, c, seed) - 0.5f);
        amplitude = amplitude * 0.62f;
        frequency = frequency * 2.0f;
    }
    FIELD_PRECISE float value = 0.5f + 0.9f * sum;
    return min(max(value, 0.0f), 1.0f);
}

// A ball with a fine gyroid carved in, like a piece of coral: large empty and full parts, and much
// detail. The ball shrinks and grows again, and the gyroid travels through it.
FIELD_FUNCTION float field_coral(FieldMotion m, float x, float y, float z) {
    FIELD_PRECISE float a = 14.0f * (x + 1.0f) + m.phase, b = 14.0f * (y + 1.0f),
                        c = 14.0f * (z + 1.0f);
    FIELD_PRECISE float gyroid = field_waves(a, b, c);
    FIELD_PRECISE float inside = 0.47f - (0.5f + 0.05f * m.swell) * field_length(x, y, z);
    FIELD_PRECISE float steep = 3.0f * inside;
    FIELD_PRECISE float skin = min(steep, 0.35f);
    FIELD_PRECISE float value = 0.5f + min(steep, 0.0f) + 0.22f * (0.6f * gyroid + max(skin, 0.0f));
    return min(max(value, 0.0f), 1.0f);
}

// From 0 to 1, `steepness` for each unit of t, from t = 0 on.
FIELD_FUNCTION float field_ramp(float t, float steepness) {
    FIELD_PRECISE float ramp = t * steepness;
    return min(max(ramp, 0.0f), 1.0f);
}

// Value noise without octaves, of so many cells a unit of length.
FIELD_FUNCTION float field_bumps(float frequency, float x, float y, float z, uint seed) {
    FIELD_PRECISE float a = frequency * x, b = frequency * y, c = frequency * z;
    return field_value_noise(a, b, c, seed);
}

// The depth below the surface of an ellipsoid, whose radii are 1 over `sx`, `sy` and `sz`.
FIELD_FUNCTION float field_below(float radius, float sx, float x, float sy, float y, float sz,
                                 float z) {
    FIELD_PRECISE float a = sx * x, b = sy * y, c = sz * z;
    FIELD_PRECISE float below = radius - field_length(a, b, c);
    return below;
}

// Shells, as a CT of a head has them: skin (0.3) around a skull (1) with sockets and a jaw, around
// a folded brain (to 0.65). The face looks along -y. In time the folds travel.
FIELD_FUNCTION float field_head(FieldMotion m, float x, float y, float z) {
    FIELD_PRECISE float front = y + 0.88f;
    FIELD_PRECISE float lumps = 0.06f * field_bumps(5.0f, x, y, z, 1u);
    FIELD_PRECISE float cranium = field_below(0.97f, 1.25f, x, 1.05f, y, 1.2f, z - 0.125f) - lumps;
    FIELD_PRECISE float jaw = field_below(0.62f, 1.3f, x, 1.05f, y + 0.33f, 1.0f, z + 0.5f) - lumps;
    FIELD_PRECISE float eyes =
        field_below(0.19f, 1.0f, max(x, -x) - 0.3f, 0.7f, front, 1.0f, z + 0.02f);
    FIELD_PRECISE float nose = field_below(0.13f, 1.4f, x, 0.6f, front, 1.0f, z + 0.34f);
    FIELD_PRECISE float depth = max(cranium, jaw), hollow = max(eyes, nose);
    FIELD_PRECISE float a = 28.0f * x + 40.0f * lumps + m.phase, b = 28.0f * y, c = 28.0f * z;
    FIELD_PRECISE float folds = 0.5f + 0.15f * field_waves(a, b, c);
    FIELD_PRECISE float skin = 0.3f * field_ramp(depth, 20.0f);
    FIELD_PRECISE float bone = field_ramp(depth - 0.06f, 25.0f) - field_ramp(depth - 0.14f, 25.0f);
    FIELD_PRECISE float skull = bone * field_ramp(-hollow, 25.0f);
    FIELD_PRECISE float brain = folds * field_ramp(cranium - 0.2f, 25.0f);
    return max(skin, max(skull, brain));
}

// Sparse tubes in a ball: the curves along which two smooth random fields are both zero. In time
// the fields shift.
FIELD_FUNCTION float field_vessels(FieldMotion m, float x, float y, float z) {
    FIELD_PRECISE float tubes = 0.0f, frequency = 2.5f;
    for (uint level = 0u; level < 2u; ++level) {
        FIELD_PRECISE float a = frequency * x + 0.5f * m.swing, b = frequency * y + 0.5f * m.swell;
        FIELD_PRECISE float c = frequency * z;
        FIELD_PRECISE float u = field_value_noise(a, b, c, 3u + level) - 0.5f;
        FIELD_PRECISE float v = field_value_noise(a + 0.5f, b + 0.5f, c + 0.5f, 7u + level) - 0.5f;
        FIELD_PRECISE float tube = 1.0f - 11.0f * field_length(u, v, 0.0f);
        tubes = max(tubes, tube);
        frequency = 2.0f * frequency;
    }
    FIELD_PRECISE float outside = field_length(x, y, z) - 0.75f;
    FIELD_PRECISE float value = tubes - 4.0f * max(outside, 0.0f);
    return max(value, 0.0f);
}

// Soft tissue with much noise (0.3 to 0.5) around bone: a hard shell with gaps, filled with struts
// (to 1). In time the struts travel.
FIELD_FUNCTION float field_bone(FieldMotion m, float x, float y, float z) {
    FIELD_PRECISE float depth = field_below(0.95f, 1.05f, x, 1.2f, y, 1.05f, z);
    FIELD_PRECISE float noise = field_bumps(130.0f, x, y, z, 1u) - 0.5f;
    FIELD_PRECISE float bend = 3.0f * field_bumps(4.0f, x, y, z, 2u);
    FIELD_PRECISE float a = 24.0f * x + bend + m.phase, b = 24.0f * y, c = 24.0f * z + bend;
    FIELD_PRECISE float struts =
        field_ramp(depth - 0.22f, 33.0f) * field_ramp(field_waves(a, b, c) - 0.5f, 3.3f);
    FIELD_PRECISE float shell = field_ramp(depth - 0.2f, 33.0f) - field_ramp(depth - 0.26f, 33.0f);
    FIELD_PRECISE float pierced = shell * field_ramp(bend - 1.5f, 10.0f);
    FIELD_PRECISE float tissue = (0.4f + 0.25f * noise) * field_ramp(depth, 25.0f);
    FIELD_PRECISE float value = tissue + 0.6f * max(pierced, struts);
    return min(max(value, 0.0f), 1.0f);
}

FIELD_FUNCTION float field_value(FieldMotion m, uint kind, uint octaves, uint seed, float x,
                                 float y, float z) {
    if (kind == FIELD_SPHERE) return field_sphere(m, x, y, z);
    if (kind == FIELD_TORUS) return field_torus(m, x, y, z);
    if (kind == FIELD_GYROID) return field_gyroid(m, x, y, z);
    if (kind == FIELD_MARSCHNER_LOBB) return field_marschner_lobb(m, x, y, z);
    if (kind == FIELD_NOISE) return field_noise(m, octaves, seed, x, y, z);
    if (kind == FIELD_CORAL) return field_coral(m, x, y, z);
    if (kind == FIELD_HEAD) return field_head(m, x, y, z);
    if (kind == FIELD_VESSELS) return field_vessels(m, x, y, z);
    return field_bone(m, x, y, z);
}

// Everything that sampling a field into a volume needs, on either side; scalar layout, 60 bytes.
struct FieldSampling {
    uint kind, octaves, seed;
    uint dims[3];         // voxels of the whole volume along i, j, k
    float scale[3];       // half the distance of neighbouring voxels along i, j, k
    float lowest;         // the value of raw 0, integer types only
    float raw_per_value;  // integer types only
    float raw_maximum;    // 255 or 65535; 0 for f32, which keeps the value itself
    FieldMotion motion;
};

// One product of whole numbers and the scale, so that both sides get the same bits.
FIELD_FUNCTION float field_sample_position(uint index, uint side, float scale) {
    return float(int(2u * index) - int(side - 1u)) * scale;
}

FIELD_FUNCTION float field_sample(FieldSampling s, uint i, uint j, uint k) {
    return field_value(s.motion, s.kind, s.octaves, s.seed,
                       field_sample_position(i, s.dims[0], s.scale[0]),
                       field_sample_position(j, s.dims[1], s.scale[1]),
                       field_sample_position(k, s.dims[2], s.scale[2]));
}

// The integer that stands for a value in a u8 or u16 volume.
FIELD_FUNCTION uint field_raw(FieldSampling s, float value) {
    FIELD_PRECISE float raw = floor((value - s.lowest) * s.raw_per_value + 0.5f);
    return uint(min(max(raw, 0.0f), s.raw_maximum));
}

#ifdef __cplusplus
static_assert(sizeof(FieldSampling) == 60);
}  // namespace isorast::field

namespace isorast {

// The level that shows the field at its best.
double field_isovalue(const Field& field);
// Fixed bounds [lo, hi] of the formula's values; integer types spread them over their whole range.
std::array<double, 2> field_range(Field::Kind kind);
// Throws Error for voxel types other than u8, u16 and f32. Volume::field must be set.
field::FieldSampling field_sampling(const Volume& volume);

}  // namespace isorast
#endif
#endif
