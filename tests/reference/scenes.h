// SPDX-License-Identifier: MIT
// The volumes that every technique must show rightly, and the cameras that look at them.
#pragma once
#include <isorast/camera.h>
#include <isorast/volume.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

namespace reference {

inline isorast::Volume sampled(const std::string& name) {
    isorast::Volume volume = isorast::make_procedural(name);
    isorast::sample(volume);
    return volume;
}

// The length of the shortest side of a voxel.
inline double voxel_side(const isorast::Volume& volume) {
    auto spacing = volume.affine.spacing();
    return std::min({spacing[0], spacing[1], spacing[2]});
}

// ISORAST_QUICK=1 in the environment asks for few views.
inline int view_count(int full) {
    const char* quick = std::getenv("ISORAST_QUICK");
    return quick && *quick == '1' ? std::min(full, 4) : full;
}

// View `index` of an endless row: all around by the golden angle, from above and from below,
// rolled; every third orthographic, every fourth zoomed in.
inline isorast::Camera view(const isorast::Volume& volume, int index) {
    isorast::OrbitOptions options;
    options.orthographic = index % 3 == 1;
    options.zoom = index % 4 == 2 ? 4 : 1.6;
    options.roll_degrees = 17 * index;
    double elevation = 80 * std::sin(2.4 * index + 0.3);
    return isorast::orbit(volume, 137.508 * index + 11, elevation, options);
}

// Voxels that the caller makes: value(i, j, k) for each.
template <typename Voxel, typename Value>
isorast::Volume volume_of(std::array<uint32_t, 3> dims, isorast::VoxelType type,
                          const Value& value) {
    isorast::Volume volume;
    volume.name = "test volume";
    volume.dims = dims;
    volume.type = type;
    std::vector<std::byte> bytes(volume.byte_count());
    auto* voxel = reinterpret_cast<Voxel*>(bytes.data());
    for (uint32_t k = 0; k < dims[2]; ++k)
        for (uint32_t j = 0; j < dims[1]; ++j)
            for (uint32_t i = 0; i < dims[0]; ++i)
                *voxel++ = Voxel(value(i, j, k));
    volume.bytes = isorast::VoxelBytes::own(std::move(bytes));
    return volume;
}

// Distance of a voxel from the middle of a cube.
inline double from_middle(uint32_t side, double i, double j, double k) {
    double middle = (side - 1) / 2.0;
    return std::hypot(i - middle, j - middle, k - middle);
}

// A ball of 100 in a shell of noise at and around 100, in zeros: at the isovalue 100 the worst case
// for tie rules. The shell is 4 voxels thick.
inline isorast::Volume random_blob(uint32_t side, uint32_t seed) {
    std::mt19937 random(seed);
    auto value = [&](double i, double j, double k) {
        constexpr std::array<int, 6> shell{0, 99, 100, 100, 101, 255};
        double distance = from_middle(side, i, j, k), radius = side / 2.0 - 2;
        int drawn = shell[random() % shell.size()];
        return distance > radius ? 0 : distance > radius - 4 ? drawn : 100;
    };
    return volume_of<uint8_t>({side, side, side}, isorast::VoxelType::u8, value);
}

// The ball in the blob.
inline isorast::Volume solid_core(uint32_t side) {
    return volume_of<uint8_t>({side, side, side}, isorast::VoxelType::u8,
                              [&](double i, double j, double k) {
                                  return from_middle(side, i, j, k) > side / 2.0 - 6 ? 0 : 100;
                              });
}

}  // namespace reference
