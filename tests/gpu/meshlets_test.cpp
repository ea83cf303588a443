// SPDX-License-Identifier: MIT
// meshlets draws what direct's hardware rasterizer draws, bit for bit: the same vertices from the
// same formula, through the same transformation. And it culls.
#include <cstring>

#include "gpu/gpu_fixture.h"

namespace {

using namespace isorast;
using namespace reference;

void expect_direct(Gpu& gpu, const Volume& volume, const std::vector<double>& isovalues,
                   const std::vector<Camera>& cameras, uint32_t max_brick_side = 0) {
    Renderer direct(gpu, volume, {.technique = "direct", .rasterizer = Rasterizer::hardware});
    Renderer meshlets(gpu, volume, {.technique = "meshlets", .max_brick_side = max_brick_side});
    for (size_t i = 0; i < cameras.size(); ++i) {
        Frame f;
        f.isovalues = isovalues;
        f.camera = cameras[i];
        f.size = {320, 240};
        f.want_depth = true;
        const Image a = direct.render(f), b = meshlets.render(f);
        EXPECT_TRUE(a.depth == b.depth && a.rgba == b.rgba) << volume.name << ", camera " << i;
    }
}

TEST_F(GpuTest, MeshletsDrawWhatDirectDraws) {
    if (GRAPHICS_CRASHES || !gpu.info().why_not_hardware.empty()) GTEST_SKIP();
    for (const std::string name : {"gyroid:48x64x41", "noise:65:octaves=4:type=u8"}) {
        const Volume volume = sampled(name);
        const double level = suggest_isovalue(volume, statistics(volume));
        std::vector<Camera> cameras;
        for (int index = 0; index < view_count(12); ++index)
            cameras.push_back(view(volume, index));
        cameras.push_back(cameras[0]);  // the eye inside
        for (size_t axis = 0; axis < 3; ++axis)
            cameras.back().position[axis] +=
                0.9 * (cameras[0].target[axis] - cameras[0].position[axis]);
        expect_direct(gpu, volume, {level}, cameras);
        expect_direct(gpu, volume, {level, 0.9 * level + 0.05}, cameras);
        expect_direct(gpu, volume, {level}, cameras, /* max_brick_side= */ 27);
    }
    // Many voxels at the isovalue.
    const Volume blob = random_blob(48, 3);
    expect_direct(gpu, blob, {100}, {view(blob, 0), view(blob, 1), view(blob, 2)});
}

TEST_F(GpuTest, MeshletsThatNothingShowsAreNotDrawn) {
    if (GRAPHICS_CRASHES || !gpu.info().why_not_hardware.empty()) GTEST_SKIP();
    // Of a sphere, the first frame already leaves out the back; in noise, the second frame knows.
    for (const auto& [name, level, cold_share, warm_share] :
         {std::tuple{"sphere:96", 0.25, 0.8, 0.8},
          {"noise:96:octaves=3:type=u8", 0.5, 1.0, 0.75}}) {
        const Volume volume = sampled(name);
        Renderer renderer(gpu, volume, {.technique = "meshlets"});
        Frame f = frame(orbit(volume, 30, 20), {level});
        f.size = {640, 480};
        const Image cold = renderer.render(f);
        const auto all = double(renderer.stats().blocks_active);
        EXPECT_LE(double(renderer.stats().blocks_drawn), cold_share * all) << name;
        const Image warm = renderer.render(f);
        EXPECT_LE(double(renderer.stats().blocks_drawn), warm_share * all) << name;
        f.culling = false;
        const Image whole = renderer.render(f);
        EXPECT_EQ(double(renderer.stats().blocks_drawn), all) << name;
        EXPECT_TRUE(cold.depth == whole.depth && cold.rgba == whole.rgba) << name;
        EXPECT_TRUE(warm.depth == whole.depth && warm.rgba == whole.rgba) << name;
    }
}

}  // namespace
