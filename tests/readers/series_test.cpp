// SPDX-License-Identifier: MIT
// Series of files, of the steps of one file, and of formulas; members that do not belong.
#include <isorast/error.h>

#include "nifti_file.h"
#include "support.h"

namespace isorast::test {
namespace {

const std::string NRRD_2X2X2 =
    "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n";

// The first voxel of each step, as a character.
std::string first_voxels(const Series& series) {
    std::string text;
    for (uint32_t step = 0; step < series.steps; ++step) {
        const Volume volume = series.load(step);
        EXPECT_EQ(volume.time_step, step);
        EXPECT_EQ(volume.time_steps, series.steps);
        text += static_cast<char>(volume.bytes.span()[0]);
    }
    return text;
}

// The one line of what is thrown.
template <class Call>
std::string message_of(Call&& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return "";
}

TEST(Series, ADirectoryInTheOrderOfTheNumbers) {
    const Scratch scratch;
    const std::vector<std::string> names{"t10.nrrd", "t2.nrrd",  "t002.nrrd", "t1.nrrd",
                                         "a.nrrd",   "t1b.nrrd", "T1.nrrd"};
    char letter = 'a';
    for (const std::string& name : names)
        scratch.write(name, NRRD_2X2X2 + std::string(8, letter++));
    scratch.write("notes.txt", "not a volume");
    scratch.write(".hidden.nrrd", "not a volume either");
    std::filesystem::create_directory(scratch.path("more.nrrd"));
    const Series series = open_series({scratch.path("")});
    EXPECT_EQ(series.steps, 7u);
    // T1, a, t1, t1b, t002, t2, t10
    EXPECT_EQ(first_voxels(series), "gedfcba");
}

TEST(Series, OneFileInADirectoryGivesItsSteps) {
    const Scratch scratch;
    scratch.write("only.nrrd",
                  "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 2 3\nencoding: raw\n\n" +
                      std::string(8, 'a') + std::string(8, 'b') + std::string(8, 'c'));
    EXPECT_EQ(first_voxels(open_series({scratch.path("")})), "abc");
}

TEST(Series, AHeadersDataFilesAreNoSteps) {
    const Scratch scratch;
    for (const std::string name : {"0", "1"}) {
        scratch.write(name + ".mhd",
                      "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n"
                      "ElementDataFile = " +
                          name + ".raw\n");
        scratch.write(name + ".raw", std::string(8, name[0]));
    }
    EXPECT_EQ(first_voxels(open_series({scratch.path("")})), "01");
}

TEST(Series, FilesInTheOrderGiven) {
    const Scratch scratch;
    const std::string b = scratch.write("b.nrrd", NRRD_2X2X2 + "bbbbbbbb");
    const std::string a = scratch.write("a_2x2x2_uint8.raw", "aaaaaaaa");
    EXPECT_EQ(first_voxels(open_series({b, a, b})), "bab");
}

TEST(Series, RawFilesWithOptions) {
    const Scratch scratch;
    scratch.write("1.raw", "xaaaaaaaa");
    scratch.write("2.raw", "xbbbbbbbb");
    LoadOptions options;
    options.dims = {{2, 2, 2}};
    options.type = VoxelType::u8;
    options.offset = 1;
    EXPECT_EQ(first_voxels(open_series({scratch.path("")}, options)), "ab");
}

TEST(Series, StepsOfA4DNiftiPlainAndCompressed) {
    const Scratch scratch;
    NiftiFile header;
    header.dim = {4, 4, 3, 2, 5, 1, 1, 1};
    header.slope = 2;
    header.intercept = -7;
    const auto values = voxels<int16_t>(size_t{24} * 5);
    const std::string bytes = header.header() + bytes_of_values(values);
    for (const std::string& path :
         {scratch.write("a.nii", bytes), scratch.write("a.nii.gz", gzip(bytes))}) {
        const Series series = open_series({path});
        ASSERT_EQ(series.steps, 5u);
        for (const uint32_t step : {4u, 0u, 2u, 3u, 1u}) {
            const Volume volume = series.load(step);
            const auto begin = values.begin() + 24 * ptrdiff_t{step};
            expect_voxels(volume, std::vector<int16_t>(begin, begin + 24));
            EXPECT_EQ(volume.slope, 2);
            EXPECT_NO_THROW(check_step(volume, series.load(0)));
        }
    }
}

TEST(Series, StepsOfAFormula) {
    const Series series = open_series({"coral:12:steps=4"});
    EXPECT_EQ(series.steps, 4u);
    EXPECT_DOUBLE_EQ(series.load(3).field->time, 0.75);
    EXPECT_EQ(open_series({"sphere:8"}).steps, 1u);
    LoadOptions options;
    options.time_step = 2;
    EXPECT_EQ(load_volume("coral:12:steps=4", options).time_step, 2u);
    options.time_step = 4;
    EXPECT_EQ(error_of("coral:12:steps=4", options),
              "coral:12:steps=4: expected a time step from 0 to 3, found 4");
}

TEST(Series, WhatIsNoSeries) {
    const Scratch scratch;
    EXPECT_THROW(open_series({}), Error);
    const std::string empty = scratch.path("");
    EXPECT_NE(message_of([&] { open_series({empty}); }).find("no volume file"), std::string::npos);
    scratch.write("a.nrrd", NRRD_2X2X2 + "aaaaaaaa");
    scratch.write("b.nrrd", NRRD_2X2X2 + "bbbbbbbb");
    scratch.write("c.nii", "?");
    EXPECT_NE(message_of([&] { open_series({empty}); }).find("found 1 NIfTI and 2 NRRD; name the"),
              std::string::npos);
    EXPECT_NE(message_of([&] { open_series({scratch.path("none")}); }).find("no such file"),
              std::string::npos);
    const std::string steps = scratch.write(
        "steps.nrrd", "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 2 2\nencoding: raw\n\n" +
                          std::string(16, 'a'));
    EXPECT_EQ(message_of([&] { open_series({scratch.path("a.nrrd"), steps}); }),
              steps + ": expected one time step in each of 2 files, found 2 in this one");
}

TEST(Series, HeadersAloneAreReadAtFirst) {
    const Scratch scratch;
    NiftiFile header;
    header.dim = {4, 4, 3, 2, 5, 1, 1, 1};
    const std::string cut = gzip(header.header() + std::string(100, 'x'));
    const Series series = open_series({scratch.write("cut.nii.gz", cut)});
    EXPECT_EQ(series.steps, 5u);
    EXPECT_THROW(series.load(4), Error);
}

// A step of a compressed file may be read where the one before it ended, or from the start.
TEST(Series, StepsInACompressedStream) {
    const Scratch scratch;
    NiftiFile header;
    header.big_endian = true;
    header.dim = {4, 4, 3, 2, 6, 1, 1, 1};
    const auto values = voxels<int16_t>(size_t{24} * 6);
    const std::string whole = header.header() + bytes_of_values(values, /* big_endian= */ true);
    const auto expect_step = [&](const Series& series, uint32_t step) {
        const auto begin = values.begin() + 24 * ptrdiff_t{step};
        expect_voxels(series.load(step), std::vector<int16_t>(begin, begin + 24));
    };
    const Series series = open_series({scratch.write("a.nii.gz", gzip(whole))});
    const Series copy = series;
    for (const uint32_t step : {0u, 1u, 2u, 5u, 3u, 3u, 4u, 0u, 5u}) {
        expect_step(series, step);
        expect_step(copy, 5 - step);
    }
    // Only what is behind the cut is missing, and what follows too much is found at the end.
    const std::string path = scratch.write("b.nii.gz", gzip(whole.substr(0, whole.size() - 50)));
    const Series cut = open_series({path});
    for (const uint32_t step : {0u, 3u, 4u, 1u})
        if (step < 4) expect_step(cut, step);
    const std::string message = message_of([&] { cut.load(5); });
    EXPECT_TRUE(message.starts_with(path + ": expected")) << message;
    expect_step(cut, 2);
    const Series longer = open_series({scratch.write("c.nii.gz", gzip(whole + "more"))});
    expect_step(longer, 4);
    EXPECT_NE(message_of([&] { longer.load(5); }).find("found more"), std::string::npos);
}

TEST(Series, AMemberThatDiffersIsNamed) {
    const Scratch scratch;
    const std::string a = scratch.write("a.nrrd", NRRD_2X2X2 + "aaaaaaaa");
    const std::string b = scratch.write(
        "b.nrrd",
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 3\nencoding: raw\n\nbbbbbbbbbbbb");
    EXPECT_TRUE(message_of([&] {
                    open_series({a, a, b});
                }).starts_with(b + ": expected the dimensions of " + a + ", 2x2x2, found 2x2x3"));
    const Volume first = make_procedural("sphere:8");
    const auto differs = [&](const std::string& name, auto change) {
        Volume other = make_procedural(name);
        change(other);
        return message_of([&] { check_step(other, first); });
    };
    const auto as_it_is = [](Volume&) {};
    EXPECT_EQ(differs("sphere:8x8x9", as_it_is),
              "sphere:8x8x9: expected the dimensions of sphere:8, 8x8x8, found 8x8x9; the steps of "
              "a series may differ in nothing but their voxels");
    EXPECT_NE(differs("torus:8", [](Volume& v) { v.type = VoxelType::u16; })
                  .find("type of sphere:8, f32, found u16"),
              std::string::npos);
    EXPECT_NE(differs("torus:8", [](Volume& v) { v.slope = 2; })
                  .find("scaling of sphere:8, voxel * 1 + 0, found voxel * 2 + 0"),
              std::string::npos);
    EXPECT_NE(differs("torus:8:spacing=1,1,2", as_it_is).find("affine of sphere:8, ("),
              std::string::npos);
    EXPECT_NO_THROW(check_step(make_procedural("torus:8"), first));
}

}  // namespace
}  // namespace isorast::test
