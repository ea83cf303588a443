// SPDX-License-Identifier: MIT
// Real volumes, where their folder is at hand: known sizes and ranges, and the same voxels and
// affines as ITK and nibabel read.
#include <isorast/error.h>

#include "oracle.h"
#include "support.h"

namespace isorast::test {
namespace {

struct Known {
    const char* file;
    std::array<uint32_t, 3> dims;
    VoxelType type;
    double minimum, maximum;  // of the raw values
    const char* not_in_itk = nullptr;
};

const Known FILES[] = {
    {"raw/Bucky_32x32x32_uint8.raw", {32, 32, 32}, VoxelType::u8, 0, 255, "raw"},
    {"raw/engine_256x256x128_uint8.raw", {256, 256, 128}, VoxelType::u8, 0, 255, "raw"},
    {"raw/nucleon_41x41x41_uint8.raw", {41, 41, 41}, VoxelType::u8, 0, 249, "raw"},
    {"raw/silicium_98x34x34_uint8.raw", {98, 34, 34}, VoxelType::u8, 0, 255, "raw"},
    {"raw/walnut_128x96x114_uint16.raw", {128, 96, 114}, VoxelType::u16, 0, 22526, "raw"},
    {"nrrd/bonsai.nrrd", {256, 256, 256}, VoxelType::u8, 0, 255},
    {"nrrd/boston_teapot.nhdr", {256, 256, 178}, VoxelType::u8, 0, 255},
    {"nrrd/fetal_template_T2.nrrd", {117, 159, 126}, VoxelType::f32, 0, 710.678},
    {"nrrd/head_512x512x511.nrrd", {512, 512, 511}, VoxelType::u8, 0, 255},
    {"nrrd/stent.nrrd", {128, 128, 256}, VoxelType::f32, 0, 1, "space directions without a space"},
    {"nrrd/tooth16.nhdr", {103, 94, 161}, VoxelType::u16, 0, 1300},
    {"metaimage/3DCT_lung_baseline.mha", {115, 157, 129}, VoxelType::i16, -2048, 1435},
    {"metaimage/HeadMRVolume.mhd", {48, 62, 42}, VoxelType::u8, 0, 255},
    {"metaimage/frogtissue.mhd",
     {500, 470, 136},
     VoxelType::u8,
     0,
     29,
     "a wrong CompressedDataSize, which ITK believes"},
    {"nifti/CT_pitch.nii.gz", {175, 248, 58}, VoxelType::u8, 0, 255},
    {"nifti/carp.nii.gz", {256, 512, 256}, VoxelType::u8, 0, 254},
    {"nifti/ch256.nii.gz", {208, 256, 219}, VoxelType::u8, 0, 127},
    {"nifti/ch2better.nii.gz", {301, 370, 316}, VoxelType::u8, 0, 130},
    {"nifti/mricrogl_ct.nii.gz", {208, 256, 225}, VoxelType::u8, 0, 255, "ITK applies its slope"},
};

class RealFiles : public ::testing::TestWithParam<Known> {
protected:
    void SetUp() override {
        const auto folder = data_folder();
        if (!folder || !std::filesystem::exists(*folder + "/" + GetParam().file))
            GTEST_SKIP() << GetParam().file << " is not at hand (set ISORAST_DATA)";
        path = *folder + "/" + GetParam().file;
    }
    std::string path;
};

TEST_P(RealFiles, KnownSizeAndRange) {
    Volume volume = load_volume(path);
    EXPECT_EQ(volume.dims, GetParam().dims);
    EXPECT_EQ(volume.type, GetParam().type);
    volume.slope = 1;
    volume.intercept = 0;
    const Statistics known = statistics(volume);
    EXPECT_NEAR(known.minimum, GetParam().minimum, 1e-3);
    EXPECT_NEAR(known.maximum, GetParam().maximum, 1e-3);
}

TEST_P(RealFiles, LikeItk) {
    if (!has_itk()) GTEST_SKIP() << "built without ITK";
    if (GetParam().not_in_itk != nullptr) GTEST_SKIP() << GetParam().not_in_itk;
    expect_like_itk(path);
}

INSTANTIATE_TEST_SUITE_P(Readers, RealFiles, ::testing::ValuesIn(FILES), [](const auto& test) {
    std::string name = test.param.file;
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
});

TEST(RealNifti, LikeNibabel) {
    const auto folder = data_folder();
    if (!folder) GTEST_SKIP() << "no folder with real volumes (set ISORAST_DATA)";
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::directory_iterator(*folder + "/nifti"))
        paths.push_back(entry.path().string());
    const auto dumps = nibabel_dumps(paths);
    if (dumps.empty()) GTEST_SKIP() << "nibabel is not installed";
    EXPECT_EQ(dumps.size(), paths.size());
    for (const auto& [path, dump] : dumps)
        expect_like_nibabel(path, dump);
}

}  // namespace
}  // namespace isorast::test
