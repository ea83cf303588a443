// SPDX-License-Identifier: MIT
// What --rasterizer auto becomes: found once, remembered, and never in the way.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "gpu/device.h"
#include "gpu/gpu_fixture.h"

namespace {

using namespace isorast;
namespace fs = std::filesystem;

// XDG_CACHE_HOME is `path` for as long as this lives; what lies there then goes.
class CacheAt {
public:
    explicit CacheAt(fs::path path) : path_(std::move(path)) {
        setenv("XDG_CACHE_HOME", path_.c_str(), /* overwrite= */ 1);
    }
    CacheAt(const CacheAt&) = delete;
    CacheAt& operator=(const CacheAt&) = delete;
    ~CacheAt() {
        setenv("XDG_CACHE_HOME", before_.c_str(), /* overwrite= */ 1);
        if (fs::is_directory(path_)) fs::remove_all(path_);
    }

private:
    fs::path path_;
    std::string before_ = std::getenv("XDG_CACHE_HOME");
};

RasterizerChoice choose_anew(Gpu& gpu) {
    gpu.device().rasterizer_choice.reset();
    return choose_rasterizer(gpu);
}

std::string text_of(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(GpuTest, TheComputeRasterizerPassesItsSelfTest) {
    const CacheAt nowhere("/dev/null");
    for (const VoxelType type : {VoxelType::u8, VoxelType::i16, VoxelType::f64}) {
        gpu.device().rasterizer_choice.reset();
        const RasterizerChoice choice = choose_rasterizer(gpu, type);
        EXPECT_EQ(choice.problem, "");
        EXPECT_NE(choice.rasterizer, Rasterizer::automatic);
        if (gpu.device().is_cpu()) {
            EXPECT_EQ(choice.rasterizer, Rasterizer::compute);
        }
    }
}

TEST_F(GpuTest, TheChoiceIsRememberedForDeviceAndDriver) {
    // The test may run at another width at the same time.
    const fs::path folder = fmt::format("{}/choose-{}", std::getenv("XDG_CACHE_HOME"), getpid());
    const CacheAt here(folder);
    const RasterizerChoice found = choose_anew(gpu);
    std::vector<fs::path> files{fs::directory_iterator(folder / "isorast"), {}};
    ASSERT_EQ(files.size(), 1u);
    const std::string text = text_of(files[0]);
    EXPECT_NE(text.find(gpu.info().name), std::string::npos);
    EXPECT_NE(text.find(gpu.info().driver), std::string::npos);

    // It is read: times that nobody measured come back.
    const std::string key = text.substr(0, text.find('\n') + 1);
    std::ofstream(files[0]) << key << "hardware\nplanted\n12 34 raster\n";
    const RasterizerChoice planted = choose_anew(gpu);
    EXPECT_EQ(planted.rasterizer, Rasterizer::hardware);
    EXPECT_EQ(planted.problem, "planted");
    EXPECT_EQ(planted.hardware_ms, 12);
    EXPECT_EQ(planted.compute_ms, 34);
    EXPECT_EQ(planted.occlusion, Occlusion::raster);

    // Half a file, or another device's, is as good as none.
    for (const std::string& bad :
         {key, key + "hardware\n", std::string("x\ncompute\n\n1 2 hiz\n")}) {
        std::ofstream(files[0]) << bad;
        EXPECT_EQ(choose_anew(gpu).rasterizer, found.rasterizer);
        EXPECT_NE(text_of(files[0]), bad);
    }
}

TEST_F(GpuTest, WhereComputeFailsSomethingElseDraws) {
    const Volume volume = reference::sampled("torus:16");
    if (gpu.info().why_not_hardware.empty() && !GRAPHICS_CRASHES) {
        gpu.device().rasterizer_choice = {.rasterizer = Rasterizer::hardware, .problem = "planted"};
        EXPECT_EQ(Renderer(gpu, volume).rasterizer(), Rasterizer::hardware);
    }
    gpu.device().rasterizer_choice = {.rasterizer = Rasterizer::automatic, .problem = "planted"};
    EXPECT_EQ(Renderer(gpu, volume).technique(), "raymarch");
    EXPECT_THROW(Renderer(gpu, volume, {.technique = "direct"}), Error);
    const RendererOptions asked{.technique = "direct", .rasterizer = Rasterizer::compute};
    EXPECT_EQ(Renderer(gpu, volume, asked).rasterizer(), Rasterizer::compute);
}

}  // namespace
