// SPDX-License-Identifier: MIT
// Typed access to voxel bytes, which may lie at any alignment (a mapped file's header has any
// length).
#pragma once
#include <isorast/volume.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

namespace isorast {

template <class T>
T load_voxel(const std::byte* bytes, uint64_t index) {
    T value;
    std::memcpy(&value, bytes + index * sizeof(T), sizeof(T));
    return value;
}

// Calls f with a zero of the C++ type that `type` stands for, and returns what f returns.
template <class F>
decltype(auto) with_type(VoxelType type, F&& f) {
    switch (type) {
        case VoxelType::u8:
            return f(uint8_t{});
        case VoxelType::i8:
            return f(int8_t{});
        case VoxelType::u16:
            return f(uint16_t{});
        case VoxelType::i16:
            return f(int16_t{});
        case VoxelType::u32:
            return f(uint32_t{});
        case VoxelType::i32:
            return f(int32_t{});
        case VoxelType::f32:
            return f(float{});
        case VoxelType::f64:
            break;
    }
    return f(double{});
}

// Finite raw values from all over a volume, about `most` of them; the same each time.
template <class T>
std::vector<double> sample_raw(const Volume& volume, uint64_t most) {
    const std::byte* bytes = volume.bytes.span().data();
    const uint64_t count = volume.voxel_count();
    const uint64_t step = std::max(count / most, uint64_t{1}) | 1;  // not always the same column
    std::vector<double> values;
    for (uint64_t index = 0; index < count; index += step) {
        const auto raw = static_cast<double>(load_voxel<T>(bytes, index));
        if (std::isfinite(raw)) values.push_back(raw);
    }
    return values;
}

// All but the voxels.
Volume header_of(const Volume& volume);

// Bytes of dims and type. Throws Error for an empty dimension and for products beyond 63 bits.
uint64_t checked_byte_count(const Volume& volume);

}  // namespace isorast
