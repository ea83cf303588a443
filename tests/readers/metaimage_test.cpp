// SPDX-License-Identifier: MIT
// MetaImage: every type, way to place the data, orientation and time, each also read by ITK.
#include <fmt/format.h>
#include <isorast/error.h>

#include "oracle.h"
#include "support.h"

namespace isorast::test {
namespace {

const std::string START = "ObjectType = Image\nNDims = 3\nDimSize = 4 3 2\n";
const std::string SHORTS = START + "ElementType = MET_SHORT\n";

template <class T>
void expect_type(const Scratch& scratch, const char* word, VoxelType type) {
    const auto values = voxels<T>(24);
    for (const bool big : {false, true}) {
        const auto path = scratch.write(
            "type.mha",
            fmt::format(
                "{}ElementType = {}\nBinaryDataByteOrderMSB = {}\nElementDataFile = LOCAL\n{}",
                START, word, big ? "True" : "False", bytes_of_values(values, big)));
        const Volume volume = load_volume(path);
        EXPECT_EQ(volume.type, type) << word;
        EXPECT_EQ(volume.bytes.mapped(), !big || sizeof(T) == 1);
        expect_voxels(volume, values);
        expect_like_itk(path);
    }
    const auto text = scratch.write(
        "text.mha", fmt::format("{}BinaryData = False\nElementType = {}\nElementDataFile = "
                                "LOCAL\n{}",
                                START, word, text_of_values(values, "\n")));
    expect_voxels(load_volume(text), values);
    expect_like_itk(text);
}

TEST(MetaImage, AllTypesInBothByteOrdersAndAscii) {
    const Scratch scratch;
    expect_type<uint8_t>(scratch, "MET_UCHAR", VoxelType::u8);
    expect_type<int8_t>(scratch, "MET_CHAR", VoxelType::i8);
    expect_type<uint16_t>(scratch, "MET_USHORT", VoxelType::u16);
    expect_type<int16_t>(scratch, "MET_SHORT", VoxelType::i16);
    expect_type<uint32_t>(scratch, "MET_UINT", VoxelType::u32);
    expect_type<int32_t>(scratch, "MET_INT", VoxelType::i32);
    expect_type<float>(scratch, "MET_FLOAT", VoxelType::f32);
    expect_type<double>(scratch, "MET_DOUBLE", VoxelType::f64);
}

TEST(MetaImage, Compressed) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(24);
    const std::string packed = zlib(bytes_of_values(values));
    const std::string header = SHORTS + "CompressedData = True\n";
    const auto sized =
        scratch.write("a.mha", fmt::format("{}CompressedDataSize = {}\nElementDataFile = LOCAL\n{}",
                                           header, packed.size(), packed));
    expect_voxels(load_volume(sized), values);
    expect_like_itk(sized);
    const auto unsized = scratch.write("a.mha", header + "ElementDataFile = LOCAL\n" + packed);
    expect_voxels(load_volume(unsized),
                  values);  // which ITK misreads: it takes the header for data
    scratch.write("data.zraw", packed);
    const auto detached = scratch.write("a.mhd", header + "ElementDataFile = data.zraw\n");
    expect_voxels(load_volume(detached), values);
    expect_like_itk(detached);
}

TEST(MetaImage, DetachedDataAndHeaderSize) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(24);
    scratch.write("data.raw", bytes_of_values(values));
    scratch.write("late.raw", "12345" + bytes_of_values(values));
    for (const char* fields :
         {"ElementDataFile = data.raw\n", "HeaderSize = 5\nElementDataFile = late.raw\n",
          "HeaderSize = -1\nElementDataFile = late.raw\n",
          "HeaderSize = 0\nElementDataFile = data.raw"}) {
        const auto path = scratch.write("a.mhd", SHORTS + fields);
        EXPECT_TRUE(load_volume(path).bytes.mapped());
        expect_voxels(load_volume(path), values);
        expect_like_itk(path);
    }
    const auto dos = scratch.write("a.mhd",
                                   "NDims = 3\r\nDimSize = 4 3 2\r\nElementType = MET_SHORT\r\n"
                                   "ElementDataFile = data.raw\r\n");
    expect_voxels(load_volume(dos), values);
}

TEST(MetaImage, SlicesInSeveralFiles) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(24);
    const std::string bytes = bytes_of_values(values);
    scratch.write("s08.raw", bytes.substr(0, 24));
    scratch.write("s10.raw", bytes.substr(24));
    for (const char* files :
         {"LIST\ns08.raw\ns10.raw\n", "LIST 2\ns08.raw\ns10.raw\n", "s%02d.raw 8 10 2\n"}) {
        const auto path =
            scratch.write("a.mhd", fmt::format("{}ElementDataFile = {}", SHORTS, files));
        expect_voxels(load_volume(path), values);
        expect_like_itk(path);
    }
}

TEST(MetaImage, NamesEndAtAnEqualsSignOrAColon) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(24);
    scratch.write("a:b.raw", bytes_of_values(values));
    for (const char* fields :
         {"NDims: 3\nDimSize: 4 3 2\nElementType : MET_SHORT\nElementSpacing:0.5 2 3\n"
          "ElementDataFile: a:b.raw\n",
          "NDims = 3\nDimSize: 4 3 2\nElementType = MET_SHORT\nElementSpacing = 0.5 2 3\n"
          "ElementDataFile = a:b.raw\n"}) {
        const auto path = scratch.write("a.mhd", fields);
        expect_voxels(load_volume(path), values);
        expect_affine(load_volume(path), {{{0.5, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 3, 0}}});
        expect_like_itk(path);
    }
}

std::string with_fields(const Scratch& scratch, const std::string& fields) {
    return scratch.write("a.mha",
                         SHORTS + fields + "ElementDataFile = LOCAL\n" + std::string(48, 'x'));
}

TEST(MetaImage, SpacingAndSize) {
    const Scratch scratch;
    for (const char* fields : {"ElementSpacing = 0.5 2 3\n", "ElementSize = 0.5 2 3\n",
                               "ElementSize = 7 7 7\nElementSpacing = 0.5 2 3\n",
                               "ElementSpacing = 0.5 2 3\nElementSize = 7 7 7\n"}) {
        const auto path = with_fields(scratch, fields);
        expect_affine(load_volume(path), {{{0.5, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 3, 0}}});
        expect_like_itk(path);
    }
}

// Rows of the matrix in the file are the directions of i, j, k: columns of the affine.
TEST(MetaImage, OrientationWithoutAnatomyIsTakenAsItIs) {
    const Scratch scratch;
    for (const char* names :
         {"TransformMatrix Offset", "Rotation Position", "Orientation Origin"}) {
        const std::string words = names;
        const size_t space = words.find(' ');
        const auto path = with_fields(
            scratch,
            fmt::format("{} = 0 1 0 0.6 0 0.8 0.8 0 -0.6\n{} = 10 20 30\nElementSpacing = 1 2 3\n",
                        words.substr(0, space), words.substr(space + 1)));
        const Volume volume = load_volume(path);
        EXPECT_EQ(volume.space, Space::unknown);
        expect_affine(volume, {{{0, 1.2, 2.4, 10}, {1, 0, 0, 20}, {0, 1.6, -1.8, 30}}});
        expect_like_itk(path);
    }
}

TEST(MetaImage, AnatomyBecomesRas) {
    const Scratch scratch;
    const std::string place =
        "TransformMatrix = 0 1 0 0.6 0 0.8 0.8 0 -0.6\nOffset = 10 20 30\nElementSpacing = 1 2 3\n";
    const auto path = with_fields(scratch, place + "AnatomicalOrientation = RAI\n");
    const Volume volume = load_volume(path);
    EXPECT_EQ(volume.space, Space::ras);
    EXPECT_EQ(volume.length_units, "mm");
    expect_affine(volume, {{{0, -1.2, -2.4, -10}, {-1, 0, 0, -20}, {0, 1.6, -1.8, 30}}});
    expect_like_itk(path);
    EXPECT_EQ(load_volume(with_fields(scratch, place + "AnatomicalOrientation = ???\n")).space,
              Space::unknown);
}

TEST(MetaImage, TimeIsTheFourthDimension) {
    const Scratch scratch;
    const auto values = voxels<uint16_t>(72);
    const std::string header =
        "NDims = 4\nDimSize = 4 3 2 3\nElementType = MET_USHORT\nElementSpacing = 1 2 3 4\n"
        "TransformMatrix = 0 1 0 0 1 0 0 0 0 0 1 0 0 0 0 1\nOffset = 5 6 7 8\n";
    const auto raw =
        scratch.write("raw.mha", header + "ElementDataFile = LOCAL\n" + bytes_of_values(values));
    const std::string data = zlib(bytes_of_values(values));
    const auto packed = scratch.write(
        "zlib.mha",
        fmt::format("{}CompressedData = True\nCompressedDataSize = {}\nElementDataFile = LOCAL\n{}",
                    header, data.size(), data));
    for (const std::string& path : {raw, packed}) {
        LoadOptions options;
        options.time_step = 1;
        const Volume volume = load_volume(path, options);
        EXPECT_EQ(volume.time_steps, 3u);
        expect_voxels(volume, std::vector<uint16_t>(values.begin() + 24, values.begin() + 48));
        expect_affine(volume, {{{0, 2, 0, 5}, {1, 0, 0, 6}, {0, 0, 3, 7}}});
        expect_like_itk(path);
        options.time_step = 3;
        error_of(path, options);
    }
}

TEST(MetaImage, PicturesAreVolumesOfOneSlice) {
    const Scratch scratch;
    const auto path =
        scratch.write("a.mha",
                      "NDims = 2\nDimSize = 4 3\nElementType = MET_UCHAR\n"
                      "ElementSpacing = 2 3\nOffset = 1 2\nElementDataFile = LOCAL\n" +
                          std::string(12, 'x'));
    const Volume volume = load_volume(path);
    EXPECT_EQ(volume.dims, (std::array<uint32_t, 3>{4, 3, 1}));
    expect_affine(volume, {{{2, 0, 0, 1}, {0, 3, 0, 2}, {0, 0, 1, 0}}});
    expect_like_itk(path);
}

}  // namespace
}  // namespace isorast::test
