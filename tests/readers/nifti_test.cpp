// SPDX-License-Identifier: MIT
// NIfTI-1 and -2: types, byte orders, pairs, gzip, affines, scaling and time, each also read by
// nibabel.
#include <fmt/format.h>
#include <isorast/error.h>

#include "nifti_file.h"
#include "oracle.h"
#include "support.h"

namespace isorast::test {
namespace {

void expect_all_like_nibabel(const std::vector<std::string>& paths) {
    for (const auto& [path, dump] : nibabel_dumps(paths))
        expect_like_nibabel(path, dump);
}

template <class T>
std::string write_typed(const Scratch& scratch, NiftiFile file, int datatype,
                        const std::string& name) {
    const auto values = voxels<T>(24);
    file.datatype = datatype;
    file.bitpix = 8 * sizeof(T);
    const auto path = scratch.write(name, file.header() + bytes_of_values(values, file.big_endian));
    const Volume volume = load_volume(path);
    EXPECT_EQ(volume.bytes.mapped(), !file.big_endian || sizeof(T) == 1) << path;
    expect_voxels(volume, values);
    EXPECT_EQ(volume.length_units, "mm");
    return path;
}

TEST(Nifti, AllTypesVersionsAndByteOrders) {
    const Scratch scratch;
    std::vector<std::string> paths;
    for (const int version : {1, 2}) {
        for (const bool big : {false, true}) {
            NiftiFile file;
            file.version = version;
            file.big_endian = big;
            const auto name = [&](const char* type) {
                return fmt::format("{}_{}_{}.nii", type, version, big);
            };
            paths.push_back(write_typed<uint8_t>(scratch, file, 2, name("u8")));
            paths.push_back(write_typed<int16_t>(scratch, file, 4, name("i16")));
            paths.push_back(write_typed<int32_t>(scratch, file, 8, name("i32")));
            paths.push_back(write_typed<float>(scratch, file, 16, name("f32")));
            paths.push_back(write_typed<double>(scratch, file, 64, name("f64")));
            paths.push_back(write_typed<int8_t>(scratch, file, 256, name("i8")));
            paths.push_back(write_typed<uint16_t>(scratch, file, 512, name("u16")));
            paths.push_back(write_typed<uint32_t>(scratch, file, 768, name("u32")));
        }
    }
    expect_all_like_nibabel(paths);
    for (const std::string& path : paths)
        if (path.find("_1_") != std::string::npos) expect_like_itk(path);
}

TEST(Nifti, CompressedAndPairs) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(24);
    const std::string bytes = bytes_of_values(values);
    std::vector<std::string> paths;
    for (const int version : {1, 2}) {
        NiftiFile file;
        file.version = version;
        const auto name = [&](const char* rest) { return fmt::format("v{}{}", version, rest); };
        paths.push_back(scratch.write(name("_a.nii.gz"), gzip(file.header() + bytes)));
        scratch.write(name("_b.img"), bytes);
        paths.push_back(scratch.write(name("_b.hdr"), file.pair_header()));
        scratch.write(name("_c.img.gz"), gzip(bytes));
        paths.push_back(scratch.write(name("_c.hdr.gz"), gzip(file.pair_header())));
        expect_voxels(load_volume(scratch.path(name("_b.img"))), values);
        EXPECT_TRUE(load_volume(scratch.path(name("_b.img"))).bytes.mapped());
        // A name that says .gz of a file that is not.
        expect_voxels(load_volume(scratch.write(name("_d.nii.gz"), file.header() + bytes)), values);
        // An extension between header and voxels.
        file.vox_offset = version == 1 ? 352 + 32 : 544 + 32;
        paths.push_back(
            scratch.write(name("_e.nii"), file.header() + std::string(32, '\0') + bytes));
    }
    for (const std::string& path : paths)
        expect_voxels(load_volume(path), values);
    expect_all_like_nibabel(paths);
}

// The right file, although libnifti would look for x.nii first.
TEST(Nifti, CompressedBesideUncompressed) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(24);
    const NiftiFile file;
    scratch.write("x.nii", file.header() + std::string(48, 'x'));
    expect_voxels(
        load_volume(scratch.write("x.nii.gz", gzip(file.header() + bytes_of_values(values)))),
        values);
}

NiftiFile with_affines(bool qform, bool sform) {
    NiftiFile file;
    file.pixdim = {-1, 0.5, 2, 3, 1, 1, 1, 1};
    file.qform_code = qform ? 1 : 0;
    file.sform_code = sform ? 2 : 0;
    file.quaternion = {0.1, 0.2, 0.3};
    file.qoffset = {10, 20, 30};
    file.srow = {0.5, 0.1, 0.2, -1, 0.03, 2, 0.7, -2, 0, 0.3, 3, -3};  // sheared
    return file;
}

TEST(Nifti, Affines) {
    const Scratch scratch;
    std::vector<std::string> paths;
    const std::string bytes(48, 'x');
    for (const int version : {1, 2}) {
        for (const bool qform : {false, true}) {
            for (const bool sform : {false, true}) {
                NiftiFile file = with_affines(qform, sform);
                file.version = version;
                paths.push_back(scratch.write(fmt::format("v{}_{}_{}.nii", version, qform, sform),
                                              file.header() + bytes));
            }
        }
    }
    expect_all_like_nibabel(paths);
    const Volume sheared = load_volume(scratch.path("v2_true_true.nii"));
    expect_affine(sheared, {{{0.5, 0.1, 0.2, -1}, {0.03, 2, 0.7, -2}, {0, 0.3, 3, -3}}});
    const Volume none = load_volume(scratch.path("v1_false_false.nii"));
    expect_affine(none, {{{0.5, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 3, 0}}});
    EXPECT_EQ(none.space, Space::unknown);
    expect_like_itk(scratch.path("v1_true_false.nii"));
}

TEST(Nifti, SlopeAndIntercept) {
    const Scratch scratch;
    std::vector<std::string> paths;
    const auto values = voxels<int16_t>(24);
    const auto add = [&](const char* name, double slope, double intercept) {
        NiftiFile file;
        file.slope = slope;
        file.intercept = intercept;
        paths.push_back(scratch.write(name, file.header() + bytes_of_values(values)));
    };
    add("a.nii", 0.5, -1024);
    add("b.nii", 0, 7);  // no scaling
    add("c.nii", 1, 0);
    add("d.nii", -2, 3);
    expect_all_like_nibabel(paths);
    const Volume scaled = load_volume(paths[0]);
    EXPECT_EQ(scaled.value(2, 1, 1), values[2 + 4 * (1 + 3)] * 0.5 - 1024);
    EXPECT_EQ(load_volume(paths[1]).value(1, 0, 0), values[1]);
}

TEST(Nifti, Units) {
    const Scratch scratch;
    const std::pair<int, const char*> units[] = {
        {0, ""}, {1, "m"}, {2, "mm"}, {3, "um"}, {3 + 8, "um"}};
    for (const auto& [code, name] : units) {
        NiftiFile file;
        file.units = code;
        EXPECT_EQ(
            load_volume(scratch.write("a.nii", file.header() + std::string(48, 'x'))).length_units,
            name);
    }
}

TEST(Nifti, TimeIsTheFourthDimension) {
    const Scratch scratch;
    const auto values = voxels<int16_t>(72);
    NiftiFile file;
    file.dim = {4, 4, 3, 2, 3, 1, 1, 1};
    const auto raw = scratch.write("a.nii", file.header() + bytes_of_values(values));
    file.dim[0] = 5;  // a fifth dimension of one
    const auto packed = scratch.write("b.nii.gz", gzip(file.header() + bytes_of_values(values)));
    for (const std::string& path : {raw, packed}) {
        LoadOptions options;
        options.time_step = 2;
        const Volume volume = load_volume(path, options);
        EXPECT_EQ(volume.time_steps, 3u);
        expect_voxels(volume, std::vector<int16_t>(values.begin() + 48, values.end()));
        options.time_step = 3;
        error_of(path, options);
    }
    expect_all_like_nibabel({raw});
}

TEST(Nifti, PicturesAreVolumesOfOneSlice) {
    const Scratch scratch;
    NiftiFile file;
    file.dim = {2, 4, 3, 0, 0, 0, 0, 0};
    file.pixdim = {1, 2, 3, 0, 0, 0, 0, 0};
    const Volume volume = load_volume(scratch.write("a.nii", file.header() + std::string(24, 'x')));
    EXPECT_EQ(volume.dims, (std::array<uint32_t, 3>{4, 3, 1}));
    expect_affine(volume, {{{2, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 1, 0}}});
}

}  // namespace
}  // namespace isorast::test
