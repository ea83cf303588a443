// SPDX-License-Identifier: MIT
// Which reader takes a file, what is said when none does, and options that go with every format.
#include <isorast/error.h>

#include "support.h"

namespace isorast::test {
namespace {

const std::string NRRD_2X2X2 =
    "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\nabcdefgh";

TEST(Load, EndingsInAnyCase) {
    const Scratch scratch;
    EXPECT_EQ(load_volume(scratch.write("A.NRRD", NRRD_2X2X2)).voxel_count(), 8u);
}

TEST(Load, FirstBytesWhereTheEndingSaysNothing) {
    const Scratch scratch;
    EXPECT_EQ(load_volume(scratch.write("volume.dat", NRRD_2X2X2)).voxel_count(), 8u);
}

TEST(Load, NameIsThePath) {
    const Scratch scratch;
    const std::string path = scratch.write("a.nrrd", NRRD_2X2X2);
    EXPECT_EQ(load_volume(path).name, path);
}

TEST(Load, Formulas) {
    const Volume volume = load_volume("sphere:16");
    EXPECT_EQ(volume.dims, (std::array<uint32_t, 3>{16, 16, 16}));
    EXPECT_TRUE(volume.field.has_value());
    LoadOptions options;
    options.spacing = {{1, 1, 1}};
    error_of("sphere:16", options);
}

TEST(Load, SpacingKeepsDirections) {
    const Scratch scratch;
    LoadOptions options;
    options.spacing = {{2, 3, 4}};
    const Volume volume = load_volume(
        scratch.write(
            "a.nrrd",
            "NRRD0004\ntype: uchar\ndimension: 3\nspace dimension: 3\nsizes: 2 2 2\nencoding: raw\n"
            "space directions: (0,5,0) (-5,0,0) (0,3,4)\nspace origin: (7,8,9)\n\nabcdefgh"),
        options);
    expect_affine(volume, {{{0, -3, 0, 7}, {2, 0, 2.4, 8}, {0, 0, 3.2, 9}}});
}

TEST(Load, NothingThatCouldBeAVolume) {
    const Scratch scratch;
    for (const std::string& path :
         {scratch.path("missing.nrrd"), scratch.path(""), scratch.write("empty.nrrd", ""),
          scratch.write("notes.txt", "not a volume"), scratch.write("picture.png", "\x89PNG")}) {
        const std::string message = error_of(path);
        for (const char* format : {"NRRD", "MetaImage", "NIfTI", "raw"})
            EXPECT_NE(message.find(format), std::string::npos) << message;
    }
    error_of("/dev/zero");
}

TEST(Load, RawOptionsAreForRawFiles) {
    const Scratch scratch;
    LoadOptions options;
    options.dims = {{2, 2, 2}};
    error_of(scratch.write("a.nrrd", NRRD_2X2X2), options);
}

TEST(Load, UnreadableFile) {
    const Scratch scratch;
    const std::string path = scratch.write("a.nrrd", NRRD_2X2X2);
    std::filesystem::permissions(path, std::filesystem::perms::none);
    if (access(path.c_str(), R_OK) == 0) GTEST_SKIP() << "this user may read everything";
    error_of(path);
}

}  // namespace
}  // namespace isorast::test
