// SPDX-License-Identifier: MIT
// Raw voxels to stored values.
#include "grid/stored.h"

#include <algorithm>
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

template <class T>
void store_as_float(const std::byte* bytes, const Stored& stored, uint64_t first, uint32_t count,
                    float* out, StoredRange& range) {
    for (uint32_t i = 0; i < count; ++i) {
        const T raw = load_voxel<T>(bytes, first + i);
        const float value = float((double(raw) - stored.base) * stored.sign);
        out[i] = std::isfinite(value) ? value : NOT_FINITE;
        if (!std::isfinite(value)) continue;
        range.least = std::min(range.least, value);
        range.greatest = std::max(range.greatest, value);
    }
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
