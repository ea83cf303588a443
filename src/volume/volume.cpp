// SPDX-License-Identifier: MIT
// Voxel types, the affine, single voxel values, and the check that every Volume passes before use.
#include <fmt/format.h>
#include <isorast/error.h>
#include <isorast/volume.h>

#include <cmath>
#include <cstddef>
#include <limits>

#include "volume/text.h"
#include "volume/voxels.h"

namespace isorast {
namespace {

struct TypeName {
    std::string_view word;
    VoxelType type;
};

// The first word of each type is the one that name_of() gives.
constexpr TypeName TYPE_NAMES[] = {
    {"u8", VoxelType::u8},
    {"i8", VoxelType::i8},
    {"u16", VoxelType::u16},
    {"i16", VoxelType::i16},
    {"u32", VoxelType::u32},
    {"i32", VoxelType::i32},
    {"f32", VoxelType::f32},
    {"f64", VoxelType::f64},
    {"uint8", VoxelType::u8},
    {"uint8_t", VoxelType::u8},
    {"uchar", VoxelType::u8},
    {"unsigned char", VoxelType::u8},
    {"byte", VoxelType::u8},
    {"int8", VoxelType::i8},
    {"int8_t", VoxelType::i8},
    {"signed char", VoxelType::i8},
    {"schar", VoxelType::i8},
    {"char", VoxelType::i8},
    {"uint16", VoxelType::u16},
    {"uint16_t", VoxelType::u16},
    {"ushort", VoxelType::u16},
    {"unsigned short", VoxelType::u16},
    {"unsigned short int", VoxelType::u16},
    {"int16", VoxelType::i16},
    {"int16_t", VoxelType::i16},
    {"short", VoxelType::i16},
    {"short int", VoxelType::i16},
    {"signed short", VoxelType::i16},
    {"signed short int", VoxelType::i16},
    {"uint32", VoxelType::u32},
    {"uint32_t", VoxelType::u32},
    {"uint", VoxelType::u32},
    {"unsigned int", VoxelType::u32},
    {"int32", VoxelType::i32},
    {"int32_t", VoxelType::i32},
    {"int", VoxelType::i32},
    {"signed int", VoxelType::i32},
    {"float32", VoxelType::f32},
    {"float", VoxelType::f32},
    {"single", VoxelType::f32},
    {"float64", VoxelType::f64},
    {"double", VoxelType::f64},
};

}  // namespace

size_t bytes_of(VoxelType type) {
    return with_type(type, [](auto zero) { return sizeof(zero); });
}

std::string_view name_of(VoxelType type) {
    return TYPE_NAMES[static_cast<size_t>(type)].word;
}

std::optional<VoxelType> parse_voxel_type(std::string_view word) {
    const std::string lower = lowercase(word);
    for (const TypeName& name : TYPE_NAMES)
        if (lower == name.word) return name.type;
    return std::nullopt;
}

std::array<double, 3> Affine::operator()(double i, double j, double k) const {
    std::array<double, 3> world{};
    for (int row = 0; row < 3; ++row)
        world[row] = m[row][0] * i + m[row][1] * j + m[row][2] * k + m[row][3];
    return world;
}

std::array<double, 3> Affine::spacing() const {
    std::array<double, 3> lengths{};
    for (int column = 0; column < 3; ++column)
        // Not at once: that would be NaN where an entry is infinite.
        lengths[column] = std::hypot(std::hypot(m[0][column], m[1][column]), m[2][column]);
    return lengths;
}

double Affine::determinant() const {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

double Volume::value(uint32_t i, uint32_t j, uint32_t k) const {
    const uint64_t index = (uint64_t{k} * dims[1] + j) * dims[0] + i;
    const double raw = with_type(type, [&](auto zero) {
        return static_cast<double>(load_voxel<decltype(zero)>(bytes.span().data(), index));
    });
    return raw * slope + intercept;
}

uint64_t checked_byte_count(const Volume& volume) {
    uint64_t count = bytes_of(volume.type);
    const bool overflows = __builtin_mul_overflow(count, volume.dims[0], &count) ||
                           __builtin_mul_overflow(count, volume.dims[1], &count) ||
                           __builtin_mul_overflow(count, volume.dims[2], &count);
    if (count == 0 && !overflows)
        throw Error(fmt::format("{}: {}x{}x{} voxels; every dimension must be at least 1",
                                volume.name, volume.dims[0], volume.dims[1], volume.dims[2]));
    if (overflows || count > std::numeric_limits<ptrdiff_t>::max())
        throw Error(fmt::format("{}: {}x{}x{} {} voxels are more bytes than 63 bits can count",
                                volume.name, volume.dims[0], volume.dims[1], volume.dims[2],
                                name_of(volume.type)));
    return count;
}

namespace {

// What is wrong with the affine, and what helps; empty where it can be inverted.
std::string why_not_invertible(const Affine& affine) {
    const auto& m = affine.m;
    for (int row = 0; row < 3; ++row)
        if (!std::isfinite(m[row][3]))
            return fmt::format(
                "its origin is not finite: {}, {}, {}; correct it where the file gives it", m[0][3],
                m[1][3], m[2][3]);
    const auto [x, y, z] = affine.spacing();
    const double product = x * y * z;
    if (!(product > 0) || !std::isfinite(product))
        return fmt::format("spacing {} x {} x {}; give the spacing", x, y, z);
    // Relative to the spacing, so that metres and micrometres pass alike.
    if (std::abs(affine.determinant()) > 1e-9 * product) return "";
    const auto direction = [&](int column) {
        return fmt::format("({}, {}, {})", m[0][column] + 0., m[1][column] + 0.,
                           m[2][column] + 0.);  // -0 + 0 is 0
    };
    return fmt::format(
        "its axes have the directions {}, {} and {}, which lie in one plane; correct them where "
        "the file gives them",
        direction(0), direction(1), direction(2));
}

}  // namespace

void check(const Volume& volume) {
    const uint64_t expected = checked_byte_count(volume);
    const uint64_t found = volume.bytes.span().size();
    if (found != expected && (found != 0 || !volume.field))
        throw Error(fmt::format("{}: expected {} bytes for {}x{}x{} {}, found {}", volume.name,
                                expected, volume.dims[0], volume.dims[1], volume.dims[2],
                                name_of(volume.type), found));
    if (const std::string why = why_not_invertible(volume.affine); !why.empty())
        throw Error(
            fmt::format("{}: the voxel-to-world affine cannot be inverted: {}", volume.name, why));
    if (!std::isfinite(volume.slope) || !std::isfinite(volume.intercept) || volume.slope == 0)
        throw Error(fmt::format("{}: values cannot be raw * {} + {}", volume.name, volume.slope,
                                volume.intercept));
}

}  // namespace isorast
