// SPDX-License-Identifier: MIT
// meshlets draws what direct draws, bit for bit: the same vertices from the same formula, through
// the same transformation.
#include <cstring>

#include "gpu/gpu_fixture.h"

namespace {

using namespace isorast;
using namespace reference;

void expect_direct(Gpu& gpu, const Volume& volume, const std::vector<double>& isovalues,
                   const std::vector<Camera>& cameras, uint32_t max_brick_side = 0) {
    Renderer direct(gpu, volume, {.technique = "direct"});
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

}  // namespace
