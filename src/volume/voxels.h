// SPDX-License-Identifier: MIT
// Typed access to voxel bytes, which may lie at any alignment (a mapped file's header has any
// length).
#pragma once
#include <isorast/volume.h>

#include <cstring>

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

// All but the voxels.
Volume header_of(const Volume& volume);

// Bytes of dims and type. Throws Error for an empty dimension and for products beyond 63 bits.
uint64_t checked_byte_count(const Volume& volume);

}  // namespace isorast
