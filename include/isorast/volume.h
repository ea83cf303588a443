// SPDX-License-Identifier: MIT
// Volume: scalar voxels on a regular grid, where they lie in the world, and what their numbers
// mean.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isorast {

enum class VoxelType : uint8_t { u8, i8, u16, i16, u32, i32, f32, f64 };

size_t bytes_of(VoxelType type);
std::string_view name_of(VoxelType type);
// "u8", "uint8", "uchar", "float", "int16", ... in any case; nothing for other words.
std::optional<VoxelType> parse_voxel_type(std::string_view word);

// Voxel index (i, j, k) to world position: world = m * (i, j, k, 1), m row-major, 3 rows of 4.
// Voxel centres lie at whole numbers. Spacing, direction, origin and shear are all in here.
struct Affine {
    std::array<std::array<double, 4>, 3> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

    static Affine scaling(double x, double y, double z) {
        return {{{{x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, z, 0}}}};
    }
    std::array<double, 3> operator()(double i, double j, double k) const;
    // The length of each column: distance of neighbouring voxels along i, j, k, in world units.
    std::array<double, 3> spacing() const;
    double determinant() const;
    bool operator==(const Affine&) const = default;
};

// What the world axes mean. Readers turn LPS files (DICOM, ITK, some NRRD) into RAS.
enum class Space : uint8_t { unknown, ras };

// The bytes of the voxels: owned, memory-mapped read-only from a file, or borrowed from the caller.
class VoxelBytes {
public:
    VoxelBytes() = default;
    // Throws Error when the file cannot be opened or mapped, or is shorter than offset + size.
    static VoxelBytes map(const std::string& path, uint64_t offset, uint64_t size);
    static VoxelBytes own(std::vector<std::byte> bytes);
    // The caller keeps the memory alive and unchanged for as long as the Volume lives.
    static VoxelBytes borrow(std::span<const std::byte> bytes);
    VoxelBytes(VoxelBytes&&) noexcept;
    VoxelBytes& operator=(VoxelBytes&&) noexcept;
    ~VoxelBytes();

    std::span<const std::byte> span() const { return span_; }
    bool mapped() const { return mapping_ != nullptr; }

private:
    std::span<const std::byte> span_;
    std::vector<std::byte> owned_;
    void* mapping_ = nullptr;
    size_t mapping_size_ = 0;
};

// A formula in place of voxels, over [-1, 1]^3; see src/volume/field.h. It is sampled on the GPU
// when a Renderer takes the volume, or on the CPU by sample().
struct Field {
    enum class Kind : uint32_t {
        sphere,
        torus,
        gyroid,
        marschner_lobb,
        noise,
        coral,
        head,
        vessels,
        bone
    };
    Kind kind = Kind::sphere;
    uint32_t octaves = 6;  // noise only
    uint32_t seed = 1;     // noise only
    double time = 0;       // 0 to 1: how much of the one period has gone by
};

struct Volume {
    std::string name;                // the file or the formula, for messages
    std::array<uint32_t, 3> dims{};  // voxels along i (fastest in memory), j, k
    VoxelType type = VoxelType::u8;
    VoxelBytes bytes;  // native byte order; empty while only `field` is set
    std::optional<Field> field;
    Affine affine;
    Space space = Space::unknown;
    std::string length_units;                // of the world: "mm", "um", "m", "" when unknown
    double slope = 1, intercept = 0;         // value = raw * slope + intercept
    std::string value_units;                 // "HU", ... "" when unknown
    uint32_t time_steps = 1, time_step = 0;  // how many the file holds, and which one this is

    // Products are 64-bit and checked where a Volume is made.
    uint64_t voxel_count() const { return uint64_t{dims[0]} * dims[1] * dims[2]; }
    uint64_t byte_count() const { return voxel_count() * bytes_of(type); }
    // The value (slope and intercept applied) at voxel (i, j, k). Volume must be sampled.
    double value(uint32_t i, uint32_t j, uint32_t k) const;
};

// True when `name` is spelled like a formula: "sphere:64", "noise:128:octaves=6:seed=1:type=u8",
// "gyroid:64x64x32:spacing=1,1,2", "coral:64:steps=30". Names: sphere torus gyroid marschner-lobb
// noise coral head vessels bone.
bool is_procedural(std::string_view name);
// A volume of that formula. World positions are the formula's own coordinates, [-1, 1] along the
// longest side, unless spacing is given. With "steps=" the formula varies smoothly in time: step
// `time_step` shows time_step / steps of one period, so that the last step leads back to the first.
// Throws Error that names the bad part and lists what is allowed.
Volume make_procedural(std::string_view name, uint32_t time_step = 0);
// Fill `bytes` from `field` on the CPU, if not filled yet.
void sample(Volume& volume);

// Throws Error unless dims are positive, their product is representable, and bytes (if any) match.
void check(const Volume& volume);

// Of the voxels, in data units.
struct Statistics {
    // The least or the greatest value, where it is so far from all others that it must stand for
    // "no data": ten times as far as these lie apart, and they are not only a few. It counts for
    // nothing below.
    std::optional<double> no_data;
    uint64_t without_data = 0;                                          // voxels with that value
    double minimum = 0, maximum = 0, mean = 0, standard_deviation = 0;  // over finite voxels
    uint64_t finite = 0, not_finite = 0;
    std::vector<uint64_t> histogram;  // equal bins from minimum to maximum
    // Values at equal steps of rank, from minimum to maximum; of types wider than 16 bits, of a
    // quarter of a million voxels from all over the volume.
    std::vector<double> ranked;

    // The value below which `percent` (0 to 100) of the finite voxels lie.
    double percentile(double percent) const;
};
// Throws Error for 0 bins, and as check() does.
Statistics statistics(const Volume& volume, uint32_t bins = 1024);

// An isovalue worth looking at first: the threshold that best separates the object from its
// background (Otsu 1979) for measured data; the formula's own level for procedural volumes.
double suggest_isovalue(const Volume& volume, const Statistics& statistics);

// "300", "200,600", "200:1000:100", "p99", "1.5sigma", "auto", and comma lists of these, in data
// units. Sigma counts standard deviations above the mean. `statistics` is called only if a word
// needs it. Throws Error naming the word that does not parse, or that makes more than 32.
std::vector<double> parse_isovalues(std::string_view text, const Volume& volume);

}  // namespace isorast
