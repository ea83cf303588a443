// SPDX-License-Identifier: MIT
// Raw voxels to stored values.
#include "grid/stored.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <type_traits>
#include <vector>

#include "volume/voxels.h"

namespace isorast {

namespace {

constexpr uint64_t SAMPLES = 1 << 14;
// Stored values are mostly between 1 / 2^32 and 2^32, of which squares and products are floats.
constexpr int MOST_EXPONENT = 32;

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + ptrdiff_t(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

// Without the least and the greatest, which may stand for "no data"; unless these are all.
std::vector<double> typical(const std::vector<double>& samples) {
    if (samples.empty()) return {};
    const auto [least, greatest] = std::ranges::minmax(samples);
    std::vector<double> rest;
    std::ranges::copy_if(samples, std::back_inserter(rest),
                         [&](double value) { return value != least && value != greatest; });
    return rest.empty() ? samples : rest;
}

// How far from `base` values are that are not there: a power of two.
double usual_distance(const std::vector<double>& values, double base) {
    std::vector<double> distances;
    for (const double value : values)
        if (value != base) distances.push_back(std::abs(value - base));
    return distances.empty() ? 0 : median(std::move(distances));
}

// The base and the scale of stored floats.
template <class T>
void fit_floats(const Volume& volume, Stored& stored) {
    const std::vector<double> samples = sample_raw<T>(volume, SAMPLES), values = typical(samples);
    if (!std::is_same_v<T, float>) stored.base = median(values);
    double distance = usual_distance(values, stored.base);
    if (distance == 0) distance = usual_distance(samples, stored.base);
    const int exponent = distance == 0 ? 0 : std::ilogb(distance);
    const int most = std::is_same_v<T, float> ? 126 : 1000;  // whose reciprocal is there too
    if (std::abs(exponent) > MOST_EXPONENT)
        stored.scale *= std::ldexp(1.0, std::clamp(exponent, -most, most));
}

// The float whose bits, as an integer in the order of floats, are this key.
float value_of(int32_t key) {
    return std::bit_cast<float>(key ^ (key >> 31 & 0x7fffffff));
}

// Finite raw values too large to be stored as floats.
template <class T>
void store_largest(const std::byte* bytes, const Stored& stored, uint64_t first, uint32_t count,
                   float* out, StoredRange& range) {
    for (uint32_t i = 0; i < count; ++i) {
        const auto raw = double(load_voxel<T>(bytes, first + i));
        const double moved = (raw - stored.base) / stored.scale;
        if (!std::isfinite(raw) || std::isfinite(float(moved))) continue;
        const float value = std::copysign(MOST_STORED, float(moved));
        out[i] = value;
        range.least = std::min(range.least, value);
        range.greatest = std::max(range.greatest, value);
    }
}

// What is not finite is replaced, and the range widened by the rest. In integers and without a
// branch: this becomes vector instructions, as minima of floats do not. `out` is never read: memory
// for uploads may be slow to read.
template <class T>
void store_as_float(const std::byte* bytes, const Stored& stored, uint64_t first, uint32_t count,
                    float* out, StoredRange& range) {
    constexpr int32_t EXPONENT = 0x7f800000, NOT_FINITE_BITS = std::bit_cast<int32_t>(NOT_FINITE);
    constexpr int32_t LAST = std::numeric_limits<int32_t>::max();
    using Real = std::conditional_t<std::is_same_v<T, float>, float, double>;  // floats stay exact
    const auto base = Real(stored.base), factor = Real(1 / stored.scale);
    int32_t least = LAST, greatest = -LAST, any_bad = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const T raw = load_voxel<T>(bytes, first + i);
        const auto bits = std::bit_cast<int32_t>(float((Real(raw) - base) * factor));
        const int32_t bad = -int32_t((bits & EXPONENT) == EXPONENT);  // all bits, or none
        any_bad |= bad;
        const int32_t key = bits ^ (bits >> 31 & LAST);
        out[i] = std::bit_cast<float>((bits & ~bad) | (NOT_FINITE_BITS & bad));
        least = std::min(least, (key & ~bad) | (LAST & bad));
        greatest = std::max(greatest, (key & ~bad) | (-LAST & bad));
    }
    const bool all_fit = std::is_same_v<T, float> && std::abs(stored.scale) == 1;
    if (any_bad != 0 && !all_fit) store_largest<T>(bytes, stored, first, count, out, range);
    if (least > greatest) return;
    range.least = std::min(range.least, value_of(least));
    range.greatest = std::max(range.greatest, value_of(greatest));
}

template <class T>
void store_as_integer(const std::byte* bytes, const Stored& stored, uint64_t first, uint32_t count,
                      std::byte* out) {
    using U = std::make_unsigned_t<T>;
    if (std::is_unsigned_v<T> && stored.scale > 0) {
        std::memcpy(out, bytes + first * sizeof(T), count * sizeof(T));
        return;
    }
    for (uint32_t i = 0; i < count; ++i) {
        const int raw = load_voxel<T>(bytes, first + i);
        const U value = U((raw - int(stored.base)) * int(stored.scale));
        std::memcpy(out + i * sizeof(T), &value, sizeof(U));
    }
}

}  // namespace

Stored stored_as(const Volume& volume) {
    Stored stored{.scale = volume.slope < 0 ? -1.0 : 1.0,
                  .slope = volume.slope,
                  .intercept = volume.intercept};
    const bool flipped = volume.slope < 0;
    with_type(volume.type, [&](auto zero) {
        using T = decltype(zero);
        using Limits = std::numeric_limits<T>;
        if constexpr (sizeof(T) <= 2) {
            stored.bits = 8 * sizeof(T);
            stored.format = sizeof(T) == 1 ? VK_FORMAT_R8_UNORM : VK_FORMAT_R16_UNORM;
            stored.base = double(flipped ? Limits::max() : Limits::min());
        } else {
            stored.bits = 32;
            stored.format = VK_FORMAT_R32_SFLOAT;
            if (!volume.field) fit_floats<T>(volume, stored);
        }
    });
    return stored;
}

void store_voxels(const Volume& volume, const Stored& stored, uint64_t first, uint32_t count,
                  std::byte* out, StoredRange& range) {
    const std::byte* bytes = volume.bytes.span().data();
    with_type(volume.type, [&](auto zero) {
        using T = decltype(zero);
        if constexpr (sizeof(T) <= 2)
            store_as_integer<T>(bytes, stored, first, count, out);
        else
            store_as_float<T>(bytes, stored, first, count, reinterpret_cast<float*>(out), range);
    });
}

}  // namespace isorast
