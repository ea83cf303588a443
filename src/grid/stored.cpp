// SPDX-License-Identifier: MIT
// Raw voxels to stored values.
#include "grid/stored.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "volume/voxels.h"

namespace isorast {

namespace {

// The least (or greatest) finite raw value: the origin of stored values of wide types.
template <class T>
double extreme(const Volume& volume, bool greatest) {
    const std::byte* bytes = volume.bytes.span().data();
    T best = greatest ? std::numeric_limits<T>::lowest() : std::numeric_limits<T>::max();
    for (uint64_t i = 0, n = volume.voxel_count(); i < n; ++i) {
        const T raw = load_voxel<T>(bytes, i);
        if constexpr (std::is_floating_point_v<T>)
            if (!std::isfinite(raw)) continue;
        best = greatest ? std::max(best, raw) : std::min(best, raw);
    }
    return double(best);
}

// The float whose bits, as an integer in the order of floats, are this key.
float value_of(int32_t key) {
    return std::bit_cast<float>(key ^ (key >> 31 & 0x7fffffff));
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
    const auto base = Real(stored.base), sign = Real(stored.sign);
    int32_t least = LAST, greatest = -LAST;
    for (uint32_t i = 0; i < count; ++i) {
        const T raw = load_voxel<T>(bytes, first + i);
        const auto bits = std::bit_cast<int32_t>(float((Real(raw) - base) * sign));
        const int32_t bad = -int32_t((bits & EXPONENT) == EXPONENT);  // all bits, or none
        const int32_t key = bits ^ (bits >> 31 & LAST);
        out[i] = std::bit_cast<float>((bits & ~bad) | (NOT_FINITE_BITS & bad));
        least = std::min(least, (key & ~bad) | (LAST & bad));
        greatest = std::max(greatest, (key & ~bad) | (-LAST & bad));
    }
    if (least > greatest) return;
    range.least = std::min(range.least, value_of(least));
    range.greatest = std::max(range.greatest, value_of(greatest));
}

template <class T>
void store_as_integer(const std::byte* bytes, const Stored& stored, uint64_t first, uint32_t count,
                      std::byte* out) {
    using U = std::make_unsigned_t<T>;
    if (std::is_unsigned_v<T> && stored.sign > 0) {
        std::memcpy(out, bytes + first * sizeof(T), count * sizeof(T));
        return;
    }
    for (uint32_t i = 0; i < count; ++i) {
        const int raw = load_voxel<T>(bytes, first + i);
        const U value = U((raw - int(stored.base)) * int(stored.sign));
        std::memcpy(out + i * sizeof(T), &value, sizeof(U));
    }
}

}  // namespace

Stored stored_as(const Volume& volume) {
    Stored stored{.sign = volume.slope < 0 ? -1.0 : 1.0,
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
            if (!std::is_same_v<T, float> && !volume.field)
                stored.base = extreme<T>(volume, flipped);
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
