// SPDX-License-Identifier: MIT
// Which reader takes a file, what is said when none does, and options that go with every format.
#include <isorast/error.h>
#include <unistd.h>

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

// The superuser may read everything: while this lives, be nobody instead.
class AsNobody {
public:
    AsNobody() { became_ = geteuid() == 0 && seteuid(65534) == 0; }
    AsNobody(const AsNobody&) = delete;
    AsNobody& operator=(const AsNobody&) = delete;
    ~AsNobody() {
        if (became_ && seteuid(0) != 0) std::abort();
    }

private:
    bool became_ = false;
};

void expect_permission_denied(const std::string& path) {
    const AsNobody nobody;
    const std::string message = error_of(path);
    EXPECT_NE(message.find("Permission denied"), std::string::npos) << message;
}

TEST(Load, UnreadableFileAndFolder) {
    using std::filesystem::perms;
    const Scratch scratch;
    const std::string path = scratch.write("a.nrrd", NRRD_2X2X2);
    std::filesystem::permissions(path, perms::none);
    std::filesystem::permissions(scratch.path(""), perms::all);
    expect_permission_denied(path);
    std::filesystem::permissions(scratch.path(""), perms::none);
    expect_permission_denied(path);
    std::filesystem::permissions(scratch.path(""), perms::all);
}

}  // namespace
}  // namespace isorast::test
