// SPDX-License-Identifier: MIT
// NRRD: every encoding, type, way to place the data, orientation and time, each also read by ITK.
#include <fmt/format.h>
#include <isorast/error.h>

#include <cmath>

#include "oracle.h"
#include "support.h"

namespace isorast::test {
namespace {

const std::string HEADER =
    "NRRD0004\n# a comment\ntype: short\ndimension: 3\nsizes: 4 3 2\nendian: little\n";

template <class T>
void expect_type(const Scratch& scratch, const std::string& word, VoxelType type) {
    const auto values = voxels<T>(24);
    for (const bool big : {false, true}) {
        const std::string path = scratch.write(
            "type.nrrd", "NRRD0004\ntype: " + word +
                             "\ndimension: 3\nsizes: 4 3 2\nencoding: raw\nendian: " +
                             (big ? "big" : "little") + "\n\n" + bytes_of_values(values, big));
        const Volume volume = load_volume(path);
        EXPECT_EQ(volume.type, type) << word;
        EXPECT_EQ(volume.bytes.mapped(), !big || sizeof(T) == 1);
        expect_voxels(volume, values);
        expect_like_itk(path);
    }
    const std::string text =
        scratch.write("text.nrrd", "NRRD0001\ntype: " + word +
                                       "\ndimension: 3\nsizes: 4 3 2\nencoding: ascii\n\n" +
                                       text_of_values(values, ", "));
    expect_voxels(load_volume(text), values);
}

TEST(Nrrd, AllTypesInBothByteOrdersAndAscii) {
    const Scratch scratch;
    for (const char* word : {"uchar", "unsigned char", "uint8", "uint8_t"})
        expect_type<uint8_t>(scratch, word, VoxelType::u8);
    for (const char* word : {"signed char", "int8", "int8_t"})
        expect_type<int8_t>(scratch, word, VoxelType::i8);
    for (const char* word :
         {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"})
        expect_type<uint16_t>(scratch, word, VoxelType::u16);
    for (const char* word :
         {"short", "short int", "signed short", "signed short int", "int16", "int16_t"})
        expect_type<int16_t>(scratch, word, VoxelType::i16);
    for (const char* word : {"uint", "unsigned int", "uint32", "uint32_t"})
        expect_type<uint32_t>(scratch, word, VoxelType::u32);
    for (const char* word : {"int", "signed int", "int32", "int32_t"})
        expect_type<int32_t>(scratch, word, VoxelType::i32);
    expect_type<float>(scratch, "float", VoxelType::f32);
    expect_type<double>(scratch, "double", VoxelType::f64);
}

TEST(Nrrd, Compressed) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(24);
    const std::string bytes = bytes_of_values(values);
    for (const char* encoding : {"gzip", "gz"}) {
        const auto path =
            scratch.write("a.nrrd", HEADER + "encoding: " + encoding + "\n\n" + gzip(bytes));
        expect_voxels(load_volume(path), values);
        expect_like_itk(path);
    }
    // Several gzip members in a row are one stream; zeros may follow.
    const auto members =
        HEADER + "encoding: gzip\n\n" + gzip(bytes.substr(0, 11)) + gzip(bytes.substr(11));
    expect_voxels(load_volume(scratch.write("a.nrrd", members)), values);
    expect_voxels(load_volume(scratch.write("a.nrrd", members + std::string(512, '\0'))), values);
}

TEST(Nrrd, DetachedData) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(24);
    const std::string bytes = bytes_of_values(values);
    scratch.write("data.raw", bytes);
    scratch.write("data.raw.gz", gzip(bytes));
    for (const char* field :
         {"data file: data.raw\n", "datafile: ./data.raw\n\n", "data file: data.raw\r\n"}) {
        const auto path = scratch.write("a.nhdr", HEADER + "encoding: raw\n" + field);
        EXPECT_TRUE(load_volume(path).bytes.mapped());
        expect_voxels(load_volume(path), values);
        expect_like_itk(path);
    }
    const auto path = scratch.write("a.nhdr", HEADER + "encoding: gzip\ndata file: data.raw.gz\n");
    expect_voxels(load_volume(path), values);
    expect_like_itk(path);
}

TEST(Nrrd, SkippedLinesAndBytes) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(24);
    const std::string bytes = bytes_of_values(values);
    scratch.write("data.raw", "one\ntwo\n12345" + bytes);
    scratch.write("data.gz", gzip("12345" + bytes));
    for (const char* fields :
         {"encoding: raw\nline skip: 2\nbyte skip: 5\n", "encoding: raw\nbyte skip: -1\n",
          "encoding: raw\nlineskip: 1\nbyteskip: 9\n"}) {
        const auto path = scratch.write("a.nhdr", HEADER + fields + "data file: data.raw\n");
        expect_voxels(load_volume(path), values);
        expect_like_itk(path);
    }
    // In compressed data the bytes to skip are counted after inflation.
    const auto path =
        scratch.write("a.nhdr", HEADER + "encoding: gzip\nbyte skip: 5\ndata file: data.gz\n");
    expect_voxels(load_volume(path), values);
    expect_like_itk(path);
}

TEST(Nrrd, SlicesInSeveralFiles) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(24);
    const std::string bytes = bytes_of_values(values);
    scratch.write("s08.raw", bytes.substr(0, 24));
    scratch.write("s10.raw", bytes.substr(24));
    scratch.write("s08.gz", gzip(bytes.substr(0, 24)));
    scratch.write("s10.gz", gzip(bytes.substr(24)));
    for (const char* fields : {"encoding: raw\ndata file: LIST\ns08.raw\ns10.raw\n",
                               "encoding: raw\ndata file: s%02d.raw 8 10 2\n",
                               "encoding: raw\ndata file: s%02d.raw 8 10 2 2\n",
                               "encoding: gzip\ndata file: LIST 2\ns08.gz\ns10.gz\n"}) {
        const auto path = scratch.write("a.nhdr", HEADER + fields);
        expect_voxels(load_volume(path), values);
        expect_like_itk(path);
    }
    const auto backwards =
        scratch.write("a.nhdr", HEADER + "encoding: raw\ndata file: s%02d.raw 10 8 -2\n");
    const Volume volume = load_volume(backwards);
    EXPECT_EQ(volume.value(0, 0, 1), values[0]);
}

std::string with_fields(const Scratch& scratch, const std::string& fields) {
    return scratch.write("a.nrrd",
                         HEADER + "encoding: raw\n" + fields + "\n" + std::string(48, 'x'));
}

TEST(Nrrd, Spacings) {
    const Scratch scratch;
    const auto path = with_fields(scratch, "spacings: 0.5 2 3e0\n");
    expect_affine(load_volume(path), {{{0.5, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 3, 0}}});
    EXPECT_EQ(load_volume(path).space, Space::unknown);
    expect_like_itk(path);
}

// What the message says helps does help.
TEST(Nrrd, AGivenSpacingReplacesOneThatIsNone) {
    const Scratch scratch;
    LoadOptions options;
    options.spacing = {2, 3, 4};
    for (const char* spacings : {"0 1 1", "inf 1 1", "1 -inf 1", "1 1 1e300"})
        expect_affine(
            load_volume(with_fields(scratch, fmt::format("spacings: {}\n", spacings)), options),
            {{{2, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 4, 0}}});
    const std::string flat = "space directions: (1,0,0) (1,0,0) (0,0,1)\n";
    EXPECT_NE(error_of(with_fields(scratch, flat), options)
                  .find("directions (2, 0, 0), (3, 0, 0) and (0, 0, 4), which lie in one plane"),
              std::string::npos);
}

TEST(Nrrd, AxisRanges) {
    const Scratch scratch;
    for (const char* fields : {"spacings: 0.5 2 3\naxis mins: 1 2 3\ncenters: cell cell cell\n",
                               "spacings: 0.5 2 3\naxismins: 1 2 3\ncenterings: node node node\n",
                               "spacings: 0.5 2 3\naxis mins: 1 2 3\n"})
        expect_like_itk(with_fields(scratch, fields));
    // Ranges alone give spacings too (ITK takes 1 instead).
    const Volume volume = load_volume(with_fields(scratch, "axis mins: 0 0 1\naxis maxs: 2 6 9\n"));
    expect_affine(volume, {{{0.5, 0, 0, 0.25}, {0, 2, 0, 1}, {0, 0, 4, 3}}});
}

TEST(Nrrd, SpacesBecomeRas) {
    const Scratch scratch;
    const std::string place =
        "space directions: (0,2,0) (1,0,0.5) (0, 0, 3)\nspace origin: (10,20,30)\n";
    const std::array<std::array<double, 4>, 3> ras{{{0, 1, 0, 10}, {2, 0, 0, 20}, {0, 0.5, 3, 30}}};
    const std::array<std::array<double, 4>, 3> lps{
        {{0, -1, 0, -10}, {-2, 0, 0, -20}, {0, 0.5, 3, 30}}};
    const std::array<std::array<double, 4>, 3> las{
        {{0, -1, 0, -10}, {2, 0, 0, 20}, {0, 0.5, 3, 30}}};
    const auto load = [&](const std::string& space) {
        return load_volume(with_fields(scratch, space + place));
    };
    for (const char* space : {"space: RAS\n", "space: right-anterior-superior\n"}) {
        expect_affine(load(space), ras);
        EXPECT_EQ(load(space).space, Space::ras);
        EXPECT_EQ(load(space).length_units, "mm");
    }
    for (const char* space : {"space: LPS\n", "space: left-posterior-superior\n"})
        expect_affine(load(space), lps);
    for (const char* space : {"space: LAS\n", "space: Left-Anterior-Superior\n"})
        expect_affine(load(space), las);
    expect_affine(load("space dimension: 3\n"), ras);
    EXPECT_EQ(load("space dimension: 3\n").space, Space::unknown);
    EXPECT_EQ(load("space: LPS\nspace units: \"um\" \"um\" \"um\"\n").length_units, "um");
}

// But for LAS, of which ITK 5.2 mirrors the wrong axis: left is +x in LPS too, so y must turn, not
// x.
TEST(Nrrd, SpacesLikeItk) {
    const Scratch scratch;
    const std::string place =
        "space directions: (0,2,0) (0,0,0.5) (3,0,0)\nspace origin: (10,20,30)\n";
    for (const char* space : {"space: RAS\n", "space: LPS\n", "space dimension: 3\n",
                              "space: scanner-xyz\n", "space: 3D-right-handed\n"})
        expect_like_itk(with_fields(scratch, space + place));
}

TEST(Nrrd, UnitsOfLengthInAnySpelling) {
    const Scratch scratch;
    const auto units = [&](const std::string& value) {
        return load_volume(with_fields(scratch, "space units: " + value + "\n")).length_units;
    };
    const auto quoted_units = [&](const std::string& unit) {
        return units(fmt::format("\"{0}\" \"{0}\" \"{0}\"", unit));
    };
    const std::pair<const char*, std::vector<std::string>> spellings[] = {
        {"m", {"m", "meter", "metres", "Meters"}},
        {"cm", {"cm", "centimeter", "centimetres"}},
        {"mm", {"mm", "millimeter", "millimetre", "Millimeters", "MILLIMETRES"}},
        {"um",
         {"um", "micron", "microns", "Microns", "micrometer", "micrometres", "\u00b5m", "\u03bcm",
          "\xb5m", "\\mu m"}},
        {"nm", {"nm", "nanometer", "nanometres"}},
    };
    for (const auto& [symbol, words] : spellings)
        for (const std::string& word : words)
            EXPECT_EQ(quoted_units(word), symbol) << word;
    EXPECT_EQ(units("microns microns microns"), "um");
    EXPECT_EQ(units("\"\" \"mm\" \"mm\""), "mm");
    EXPECT_EQ(units("\"???\" \"???\" \"???\""), "");
}

// Any other name is kept, as UTF-8 of at most 16 bytes that cuts no character in two.
TEST(Nrrd, OtherUnitsAreText) {
    const Scratch scratch;
    const auto load = [&](const std::string& unit) {
        return load_volume(with_fields(
            scratch,
            fmt::format("space units: \"{0}\" \"{0}\" \"{0}\"\nsample units: {0}\n", unit)));
    };
    const std::pair<std::string, std::string> cases[] = {
        {"Mm", "Mm"},
        {"parsec", "parsec"},
        {"\u00c5", "\u00c5"},
        {"\xc5", "\u00c5"},
        {"x\x1by", "x?y"},
        {"fifteen letters\u00b5", "fifteen letters"},
        {"fourteen here.\u00b5m", "fourteen here.\u00b5"},
        {"of 14 letters.\xb5m", "of 14 letters.\u00b5"},
    };
    for (const auto& [unit, text] : cases) {
        EXPECT_EQ(load(unit).length_units, text);
        EXPECT_EQ(load(unit).value_units, text);
    }
}

TEST(Nrrd, TimeIsTheLastAxis) {
    const Scratch scratch;
    const auto values = voxels<uint16_t>(4 * 3 * 2 * 3);
    const std::string header =
        "NRRD0004\ntype: ushort\ndimension: 4\nsizes: 4 3 2 3\nendian: little\n";
    for (const std::string& path :
         {scratch.write("raw.nrrd", header + "encoding: raw\n\n" + bytes_of_values(values)),
          scratch.write("gzip.nrrd", header + "encoding: gzip\nkinds: space space space time\n\n" +
                                         gzip(bytes_of_values(values))),
          scratch.write("ascii.nrrd",
                        header +
                            "encoding: ascii\nspace dimension: 3\nspace directions: (1,0,0) "
                            "(0,1,0) (0,0,1) none\n\n" +
                            text_of_values(values))}) {
        for (uint32_t step = 0; step < 3; ++step) {
            LoadOptions options;
            options.time_step = step;
            const Volume volume = load_volume(path, options);
            EXPECT_EQ(volume.time_steps, 3u);
            EXPECT_EQ(volume.time_step, step);
            expect_voxels(volume, std::vector<uint16_t>(values.begin() + 24 * step,
                                                        values.begin() + 24 * (step + 1)));
        }
        LoadOptions late;
        late.time_step = 3;
        error_of(path, late);
    }
    expect_like_itk(scratch.path("raw.nrrd"));
    const auto values_of_files =
        scratch.write("a.nhdr", header + "encoding: raw\ndata file: t%d.raw 0 2 1 3\n");
    for (size_t step = 0; step < 3; ++step)
        scratch.write(fmt::format("t{}.raw", step), bytes_of_values(values).substr(48 * step, 48));
    LoadOptions last;
    last.time_step = 2;
    EXPECT_TRUE(load_volume(values_of_files, last).bytes.mapped());
    expect_voxels(load_volume(values_of_files, last),
                  std::vector<uint16_t>(values.begin() + 48, values.end()));
}

TEST(Nrrd, PicturesAreVolumesOfOneSlice) {
    const Scratch scratch;
    const auto path =
        scratch.write("a.nrrd",
                      "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 4 3\nencoding: raw\n"
                      "spacings: 2 3\n\n" +
                          std::string(12, 'x'));
    EXPECT_EQ(load_volume(path).dims, (std::array<uint32_t, 3>{4, 3, 1}));
    expect_affine(load_volume(path), {{{2, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 1, 0}}});
    expect_like_itk(path);
    const auto placed =
        scratch.write("b.nrrd",
                      "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 4 3\nencoding: raw\n"
                      "space: RAS\nspace directions: (0,2,0) (0,0,3)\n\n" +
                          std::string(12, 'x'));
    expect_affine(load_volume(placed), {{{0, 0, 1, 0}, {2, 0, 0, 0}, {0, 3, 0, 0}}});
}

TEST(Nrrd, OneComponentIsScalar) {
    const Scratch scratch;
    const auto path =
        scratch.write("a.nrrd",
                      "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 1 4 3 2\nencoding: raw\n"
                      "kinds: vector domain domain domain\n\n" +
                          std::string(24, 'x'));
    EXPECT_EQ(load_volume(path).dims, (std::array<uint32_t, 3>{4, 3, 2}));
}

TEST(Nrrd, DosLineEndsAndUserKeys) {
    const Scratch scratch;
    const auto path =
        scratch.write("a.nrrd",
                      "NRRD0005\r\ntype: uchar\r\ndimension: 3\r\nsizes: 2 2 2\r\n"
                      "encoding: raw\r\nkey:=a: value\r\ncontent: a:=b\r\n\r\nabcdefgh");
    EXPECT_EQ(load_volume(path).value(1, 1, 1), 'h');
}

TEST(Nrrd, NotFiniteAsciiValues) {
    const Scratch scratch;
    const auto path =
        scratch.write("a.nrrd",
                      "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 1\nencoding: ascii\n\n"
                      "nan inf -inf 1e-50\n");
    const Volume volume = load_volume(path);
    EXPECT_TRUE(std::isnan(volume.value(0, 0, 0)));
    EXPECT_EQ(volume.value(1, 0, 0), INFINITY);
    EXPECT_EQ(volume.value(0, 1, 0), -INFINITY);
    EXPECT_EQ(volume.value(1, 1, 0), 0);
}

}  // namespace
}  // namespace isorast::test
