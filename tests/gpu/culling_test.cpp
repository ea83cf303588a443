// SPDX-License-Identifier: MIT
// Occlusion culling is conservative: along any way of the camera, and any change of the isovalue,
// each frame with culling has the depth and colours of that frame without, bit for bit; and it does
// cull.
#include <cstring>
#include <random>

#include "gpu/gpu_fixture.h"

namespace {

using namespace isorast;

// A camera on a walk: slow steps mostly, now and then a jump, and sometimes into the volume.
class Walk {
public:
    explicit Walk(const Volume& volume) : volume_(volume) {}

    Camera step() {
        const double kind = uniform(0, 1);
        if (kind < 0.1) {
            azimuth_ = uniform(0, 360);
            elevation_ = uniform(-80, 80);
        }
        azimuth_ += uniform(-4, 4);
        elevation_ += uniform(-3, 3);
        Camera camera = orbit(volume_, azimuth_, elevation_,
                              {.zoom = kind > 0.8 ? 3.0 : 1.0, .orthographic = kind > 0.95});
        if (kind > 0.1 && kind < 0.25)  // most of the way to the middle: the eye is inside
            for (int i = 0; i < 3; ++i)
                camera.position[i] += 0.85 * (camera.target[i] - camera.position[i]);
        return camera;
    }
    double uniform(double low, double high) {
        return std::uniform_real_distribution(low, high)(random_);
    }

private:
    const Volume& volume_;
    std::mt19937 random_{7};
    double azimuth_ = 30, elevation_ = 20;
};

bool same_bits(const Image& a, const Image& b) {
    return a.rgba == b.rgba &&
           std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * sizeof(float)) == 0;
}

// direct with one of its rasterizers: without culling, and with each occlusion test that there is.
struct Ways {
    Ways(Gpu& gpu, const Volume& volume, Rasterizer rasterizer)
        : Ways(gpu, series_of({&volume, 1}), rasterizer) {}
    // One keeps all time steps on the GPU, the others two.
    Ways(Gpu& gpu, const Series& series, Rasterizer rasterizer)
        : whole(gpu, series, {.technique = "direct", .rasterizer = rasterizer}) {
        for (Occlusion occlusion : {Occlusion::hiz, Occlusion::raster}) {
            if (occlusion == Occlusion::raster && rasterizer == Rasterizer::compute) continue;
            const RendererOptions options{.technique = "direct",
                                          .rasterizer = rasterizer,
                                          .occlusion = occlusion,
                                          .step_bytes = 1};
            culled.emplace_back(gpu, series, options);
            drawn.push_back(0);
        }
    }
    // Draws a frame in all ways; true if no way changes a bit.
    bool agree(Frame frame) {
        frame.culling = false;
        const Image expected = whole.render(frame);
        drawn_whole += whole.stats().blocks_drawn;
        frame.culling = true;
        bool same = true;
        for (size_t i = 0; i < culled.size(); ++i) {
            const Image image = culled[i].render(frame);
            EXPECT_TRUE(same_bits(image, expected)) << name_of(culled[i].occlusion());
            same = same && same_bits(image, expected);
            drawn[i] += culled[i].stats().blocks_drawn;
        }
        return same;
    }

    Renderer whole;
    std::vector<Renderer> culled;
    uint64_t drawn_whole = 0;
    std::vector<uint64_t> drawn;
};

// With each rasterizer that the device has.
class Culling : public GpuTest, public testing::WithParamInterface<Rasterizer> {
protected:
    void SetUp() override {
        const bool hardware = GetParam() == Rasterizer::hardware;
        if (hardware && (GRAPHICS_CRASHES || !gpu.info().why_not_hardware.empty())) GTEST_SKIP();
    }
};
INSTANTIATE_TEST_SUITE_P(Direct, Culling,
                         testing::Values(Rasterizer::hardware, Rasterizer::compute),
                         [](const auto& each) { return std::string(name_of(each.param)); });

TEST_P(Culling, ChangesNoBitOnAnyWalk) {
    const int frames = std::getenv("ISORAST_QUICK") ? 40 : 500;
    const auto walk_through = [frames](Ways& ways, const Volume& volume) {
        Walk walk(volume);
        double isovalue = 0.5;
        for (int i = 0; i < frames; ++i) {
            if (i % 7 == 0) isovalue = walk.uniform(0.35, 0.65);
            Frame f = frame(walk.step(), {isovalue});
            f.size = {160, 120};
            ASSERT_TRUE(ways.agree(f)) << "frame " << i;
        }
    };
    // Few blocks: there, as on most GPUs, groups of them are not looked at first.
    const Volume small = reference::sampled("noise:40:octaves=3:type=u8");
    Ways ways_of_small(gpu, small, GetParam());
    ASSERT_NO_FATAL_FAILURE(walk_through(ways_of_small, small));

    const Volume volume = reference::sampled("noise:56:octaves=3:type=u8");
    Ways ways(gpu, volume, GetParam());
    ASSERT_NO_FATAL_FAILURE(walk_through(ways, volume));
    for (uint64_t drawn : ways.drawn)
        EXPECT_LT(drawn, ways.drawn_whole * 9 / 10);
    // The pyramid's second, finer look is about as tight as quads at the blocks' nearest depths.
    if (ways.drawn.size() > 1) {
        EXPECT_LT(double(ways.drawn[0]), 1.05 * double(ways.drawn[1]));
    }
}

TEST_P(Culling, ChangesNoBitWhileTimeGoesOn) {
    std::vector<Volume> volumes;
    for (uint32_t step = 0; step < 16; ++step) {
        volumes.push_back(make_procedural("noise:56:octaves=3:type=u8:steps=16", step));
        sample(volumes.back());
    }
    Ways ways(gpu, series_of(volumes), GetParam());
    const int frames = std::getenv("ISORAST_QUICK") ? 24 : 96;
    for (int i = 0; i < frames; ++i) {
        // A slow orbit, a still camera, one that jumps; time that goes on, or jumps.
        const double azimuth = i % 24 < 10 ? 2 * i : i % 24 < 20 ? 40 : 90 * i;
        Frame f = frame(orbit(volumes[0], azimuth, 20), {0.5});
        f.size = {160, 120};
        f.time_step = uint32_t(i % 24 < 16 ? i % 16 : 5 * i % 16);
        ASSERT_TRUE(ways.agree(f)) << "frame " << i;
    }
    for (uint64_t drawn : ways.drawn)
        EXPECT_LT(drawn, ways.drawn_whole * 19 / 20);
}

TEST_P(Culling, AChangeChangesNoBitAndDrawsHardlyMoreThanAWarmFrame) {
    const Volume volume = make_procedural("noise:256:type=u8");
    const RendererOptions options{
        .technique = "direct", .rasterizer = GetParam(), .occlusion = Occlusion::hiz};
    Renderer culled(gpu, volume, options), whole(gpu, volume, options);
    // A GPU's compute rasterizer soon draws all of so small a volume.
    const bool in_steps = gpu.device().is_cpu() || GetParam() == Rasterizer::hardware;
    Frame f = frame(orbit(volume, 30, 20), {0.5});
    f.size = {960, 540};
    const Image cold = culled.render(f);
    const uint64_t drawn_cold = culled.stats().blocks_drawn;
    const Image warm = culled.render(f);
    const uint64_t drawn_warm = culled.stats().blocks_drawn;
    f.culling = false;
    const Image expected = whole.render(f);
    EXPECT_TRUE(same_bits(cold, expected));
    EXPECT_TRUE(same_bits(warm, expected));
    const uint64_t drawn_whole = whole.stats().blocks_drawn;
    EXPECT_LT(drawn_warm, drawn_whole / 2);
    if (in_steps) {
        EXPECT_LT(drawn_cold, drawn_warm * 5 / 4);
    }
    const auto changes_no_bit = [&] {
        f.culling = true;
        const Image changed = culled.render(f);
        f.culling = false;
        return same_bits(changed, whole.render(f));
    };
    f.camera = orbit(volume, 34, 20);  // fast, but no cut
    EXPECT_TRUE(changes_no_bit());
    if (in_steps) {
        EXPECT_LT(culled.stats().blocks_drawn, drawn_warm * 5 / 4);
    }

    // At another isovalue the surface lies behind the blocks seen last, which hide little of it.
    // With those alone drawn before: all but 56 of 16118 blocks.
    f.isovalues = {0.6};
    EXPECT_TRUE(changes_no_bit());
    if (in_steps) {
        EXPECT_LT(culled.stats().blocks_drawn, whole.stats().blocks_drawn * 3 / 5);
    }

    if (GetParam() == Rasterizer::hardware) return;  // the same lists; seconds a frame on a CPU
    f.size = {320, 240};
    f.isovalues = {0.35, 0.55};  // two surfaces, the first of which hides the second
    EXPECT_TRUE(changes_no_bit());
    f.isovalues = {0.58, 0.52};
    f.camera = orbit(volume, 36, 24);
    EXPECT_TRUE(changes_no_bit());
    f.stereo.mode = StereoMode::layers;
    f.isovalues = {0.45};
    EXPECT_TRUE(changes_no_bit());
    f.camera = orbit(volume, 40, 24);  // fast, but no cut
    EXPECT_TRUE(changes_no_bit());
}

TEST_P(Culling, HoldsForForwardShadingAndSeveralSurfaces) {
    const Volume volume = reference::sampled("noise:48:octaves=3:type=u8");
    Ways ways(gpu, volume, GetParam());
    Walk walk(volume);
    for (int i = 0; i < 20; ++i) {
        Frame f = frame(walk.step(), {0.45, 0.6});
        f.size = {160, 120};
        if (i % 2 && GetParam() == Rasterizer::hardware) {
            f.shading = Shading::forward;
            f.isovalues = {0.5};
        }
        ASSERT_TRUE(ways.agree(f)) << "frame " << i;
    }
}

TEST_F(GpuTest, AnOcclusionTestThatATechniqueLacksIsAnError) {
    const Volume volume = make_procedural("sphere:16");
    for (Occlusion occlusion : {Occlusion::hiz, Occlusion::raster})
        EXPECT_THROW(Renderer(gpu, volume, {.technique = "raymarch", .occlusion = occlusion}),
                     Error);
    EXPECT_THROW(Renderer(gpu, volume,
                          {.technique = "direct",
                           .rasterizer = Rasterizer::compute,
                           .occlusion = Occlusion::raster}),
                 Error);
}

}  // namespace
