// SPDX-License-Identifier: MIT
// Stored values: what the GPU holds in place of raw voxels. The order of data values is always
// kept: a greater stored value is a greater data value, also when the slope is negative.
#pragma once
#include <isorast/volume.h>
#include <vulkan/vulkan.h>

#include <limits>

namespace isorast {

// raw = base + scale * stored; value = raw * slope + intercept. `scale`: a power of two, negative
// if the slope is.
struct Stored {
    VkFormat format = VK_FORMAT_R8_UNORM;
    uint32_t bits = 8;  // 8, 16: integers from 0; 32: floats
    double base = 0, scale = 1;
    double slope = 1, intercept = 0;

    uint32_t bytes() const { return bits / 8; }
    double value(double stored) const { return (base + scale * stored) * slope + intercept; }
    float from_value(double value) const {
        return float(((value - intercept) / slope - base) / scale);
    }
};

// 8- and 16-bit integers stay as they are, signed ones offset. Wider integers and f64 become floats
// around a typical value, so that small differences survive; f32 stays. Of floats whose squares and
// products would not be floats, a power of two is taken out.
Stored stored_as(const Volume& volume);

// Voxels that are not finite are stored as this, below every isovalue: outside. Not the lowest
// float: the reciprocal of a difference from it must not be so small that GPUs flush it to 0.
inline constexpr float NOT_FINITE = -0x1p124f;

// What is finite, but not as a stored float, is stored as this, or less this.
inline constexpr float MOST_STORED = 0x1p123f;

// Least and greatest of the finite stored values seen so far.
struct StoredRange {
    float least = std::numeric_limits<float>::infinity();
    float greatest = -std::numeric_limits<float>::infinity();
};

// Writes `count` voxels from index `first` on, as stored, to `out`; widens `range` (floats only).
void store_voxels(const Volume& volume, const Stored& stored, uint64_t first, uint32_t count,
                  std::byte* out, StoredRange& range);

}  // namespace isorast
