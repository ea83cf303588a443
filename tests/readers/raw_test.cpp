// SPDX-License-Identifier: MIT
// Raw files: names in both spellings, options, offset, byte order, and sizes that do not match.
#include <isorast/error.h>

#include <cmath>

#include "support.h"

namespace isorast::test {
namespace {

TEST(Raw, CrossedNameGivesDimensionsAndType) {
    const Scratch scratch;
    const auto values = voxels<uint16_t>(4 * 3 * 2);
    const Volume volume =
        load_volume(scratch.write("my_head_4x3x2_uint16.raw", bytes_of_values(values)));
    EXPECT_EQ(volume.dims, (std::array<uint32_t, 3>{4, 3, 2}));
    EXPECT_EQ(volume.type, VoxelType::u16);
    EXPECT_TRUE(volume.bytes.mapped());
    EXPECT_EQ(volume.space, Space::unknown);
    expect_voxels(volume, values);
    EXPECT_EQ(volume.value(1, 2, 1), values[1 + 4 * (2 + 3 * 1)]);
}

TEST(Raw, CountedNameGivesDimensionsAndBytes) {
    const Scratch scratch;
    const Volume u8 = load_volume(scratch.write("a_5_3_2_1_1.raw", std::string(30, 'x')));
    EXPECT_EQ(u8.type, VoxelType::u8);
    EXPECT_EQ(u8.dims, (std::array<uint32_t, 3>{5, 3, 2}));
    EXPECT_EQ(load_volume(scratch.write("a_5_3_2_1_2.raw", std::string(60, 'x'))).type,
              VoxelType::u16);
    const auto values = voxels<float>(30);
    const Volume f32 = load_volume(scratch.write("a_5_3_2_1_4.raw", bytes_of_values(values)));
    EXPECT_EQ(f32.type, VoxelType::f32);
    expect_voxels(f32, values);
}

template <class T>
void expect_type(const Scratch& scratch, const std::string& word, VoxelType type) {
    const auto values = voxels<T>(27);
    const Volume volume =
        load_volume(scratch.write("v_3x3x3_" + word + ".raw", bytes_of_values(values)));
    EXPECT_EQ(volume.type, type) << word;
    expect_voxels(volume, values);
}

TEST(Raw, AllTypes) {
    const Scratch scratch;
    expect_type<uint8_t>(scratch, "uint8", VoxelType::u8);
    expect_type<int8_t>(scratch, "int8", VoxelType::i8);
    expect_type<uint16_t>(scratch, "UINT16", VoxelType::u16);
    expect_type<int16_t>(scratch, "short", VoxelType::i16);
    expect_type<uint32_t>(scratch, "u32", VoxelType::u32);
    expect_type<int32_t>(scratch, "int32", VoxelType::i32);
    expect_type<float>(scratch, "float32", VoxelType::f32);
    expect_type<double>(scratch, "float64", VoxelType::f64);
}

TEST(Raw, OptionsReplaceTheName) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(24);
    LoadOptions options;
    options.dims = {{2, 3, 4}};
    options.type = VoxelType::i16;
    options.big_endian = true;
    options.offset = 5;
    options.spacing = {{1, 2, 3}};
    const std::string file = "12345" + bytes_of_values(values, /*big_endian=*/true);
    for (const char* name : {"plain.raw", "no_extension", "other_9x9x9_uint8.raw"}) {
        const Volume volume = load_volume(scratch.write(name, file), options);
        EXPECT_FALSE(volume.bytes.mapped());
        expect_voxels(volume, values);
        expect_affine(volume, {{{1, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 3, 0}}});
    }
}

TEST(Raw, OddOffsetIsMapped) {
    const Scratch scratch;
    const auto values = voxels<double>(8);
    LoadOptions options;
    options.offset = 3;
    const Volume volume =
        load_volume(scratch.write("v_2x2x2_double.raw", "abc" + bytes_of_values(values)), options);
    EXPECT_TRUE(volume.bytes.mapped());
    EXPECT_EQ(volume.value(1, 0, 0), values[1]);
    EXPECT_EQ(statistics(volume).finite, 8u);
}

TEST(Raw, MessageSaysExpectedAndFound) {
    const Scratch scratch;
    const std::string message =
        error_of(scratch.write("head_4x4x4_uint8.raw", std::string(63, 'x')));
    EXPECT_NE(message.find("expected 64 bytes for 4x4x4 u8, found 63"), std::string::npos)
        << message;
}

struct HostileRaw {
    const char* name;
    size_t size;
    LoadOptions options = {};
};

LoadOptions with_dims(uint32_t x, uint32_t y, uint32_t z,
                      std::optional<VoxelType> type = VoxelType::u8, uint64_t offset = 0) {
    LoadOptions options;
    options.dims = {{x, y, z}};
    options.type = type;
    options.offset = offset;
    return options;
}

LoadOptions with_spacing(double x) {
    LoadOptions options;
    options.spacing = {{x, 1, 1}};
    return options;
}

LoadOptions with_time(uint32_t step) {
    LoadOptions options;
    options.time_step = step;
    return options;
}

TEST(Raw, HostileFiles) {
    const Scratch scratch;
    const HostileRaw files[] = {
        {"v_4x4x4_uint8.raw", 0},
        {"v_4x4x4_uint8.raw", 1},
        {"v_4x4x4_uint8.raw", 63},
        {"v_4x4x4_uint8.raw", 65},
        {"v_4x4x4_uint16.raw", 64},
        {"v_4x4x4_double.raw", 511},
        {"v_0x4x4_uint8.raw", 64},
        {"v_4x0x4_uint8.raw", 64},
        {"v_100000x100000x100000_uint8.raw", 64},
        {"v_4294967295x4294967295x4294967295_double.raw", 64},
        {"v_4294967296x1x1_uint8.raw", 64},
        {"v_-4x-4x4_uint8.raw", 64},
        {"v_4x4_uint8.raw", 64},
        {"v_4x4x4.raw", 64},
        {"v_4x4x4_int64.raw", 512},
        {"v_4x4x4_rgb.raw", 192},
        {"v_4_4_4_3_1.raw", 192},
        {"v_4_4_4_0_1.raw", 64},
        {"v_4_4_4_1_3.raw", 192},
        {"v_4_4_4_1_0.raw", 64},
        {"v_0_4_4_1_1.raw", 64},
        {"v_100000_100000_100000_1_4.raw", 64},
        {"v_4_4_4_1.raw", 64},
        {"plain.raw", 64},
        {"plain.raw", 64, with_dims(4, 4, 5)},
        {"plain.raw", 64, with_dims(4, 4, 4, std::nullopt)},
        {"plain.raw", 64, with_dims(0, 4, 4)},
        {"plain.raw", 64, with_dims(4, 4, 4, VoxelType::u8, 1)},
        {"plain.raw", 64, with_dims(4, 4, 4, VoxelType::u8, 64)},
        {"plain.raw", 64, with_dims(4, 4, 4, VoxelType::u8, UINT64_MAX)},
        {"plain.raw", 64, with_dims(UINT32_MAX, UINT32_MAX, 2, VoxelType::f64)},
        {"v_4x4x4_uint8.raw", 64, with_spacing(0)},
        {"v_4x4x4_uint8.raw", 64, with_spacing(-1)},
        {"v_4x4x4_uint8.raw", 64, with_spacing(NAN)},
        {"v_4x4x4_uint8.raw", 64, with_time(1)},
    };
    for (const HostileRaw& file : files)
        error_of(scratch.write(file.name, std::string(file.size, 'x')), file.options);
}

}  // namespace
}  // namespace isorast::test
