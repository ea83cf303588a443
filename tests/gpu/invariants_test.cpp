// SPDX-License-Identifier: MIT
// What must not change a picture: culling, the order of frames, bricks, the rasterizer, where a
// formula is sampled, the type that voxels are stored in; and what techniques must agree on.
#include <cstring>

#include "gpu/device.h"
#include "gpu/gpu_fixture.h"

namespace {

using namespace isorast;
using namespace reference;

bool same_bits(const Image& a, const Image& b) {
    return a.size == b.size && a.rgba == b.rgba && a.depth.size() == b.depth.size() &&
           std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * sizeof(float)) == 0;
}

double diagonal(const Volume& volume) {
    dvec3 low = vector(volume.affine(0, 0, 0));
    dvec3 high = vector(volume.affine(volume.dims[0] - 1, volume.dims[1] - 1, volume.dims[2] - 1));
    return glm::length(high - low);
}

// The same coverage, depths within 1e-6 of the box's diagonal, colours within one step of 255;
// `other` pixels may differ.
void expect_same(const Image& a, const Image& b, double range, const std::string& what,
                 uint64_t other = 0) {
    uint64_t coverage = 0, over = 0;
    for (size_t i = 0; i < a.depth.size(); ++i) {
        bool hit = std::isfinite(a.depth[i]);
        if (hit != std::isfinite(b.depth[i])) {
            ++coverage;
        } else if (hit) {
            over += std::abs(double(a.depth[i]) - double(b.depth[i])) > 1e-6 * range;
        }
    }
    EXPECT_LE(coverage, other) << what << ": pixels covered in one and not in the other";
    EXPECT_LE(over, other) << what << ": pixels with another depth";
    EXPECT_LE(compare(a, b, 1).pixels_over, other) << what << ": pixels with another colour";
}

const std::vector<std::string> SCENES{"noise:64:octaves=4:type=u8", "gyroid:48x64x40"};

TEST_F(GpuTest, CullingChangesNoBit) {
    for (const std::string& name : SCENES) {
        Volume volume = sampled(name);
        double level = suggest_isovalue(volume, statistics(volume));
        for (Lane& lane : lanes(volume)) {
            for (int index = 0; index < view_count(12); ++index) {
                Frame f = frame(view(volume, index), {level});
                Image culled = lane.renderer.render(f);
                f.culling = false;
                EXPECT_TRUE(same_bits(culled, lane.renderer.render(f)))
                    << lane.name << ' ' << name << ' ' << index;
            }
        }
    }
}

TEST_F(GpuTest, AFrameDoesNotDependOnThoseBefore) {
    Volume volume = sampled(SCENES[0]);
    for (Lane& lane : lanes(volume)) {
        Frame f = frame(view(volume, 3), {0.5});
        Renderer cold(gpu, volume, lane.options);
        Image expected = cold.render(f);
        for (int index : {0, 1, 2})
            lane.renderer.render(frame(view(volume, index), {0.3 + 0.1 * index}));
        EXPECT_TRUE(same_bits(lane.renderer.render(f), expected)) << lane.name;
        EXPECT_TRUE(same_bits(lane.renderer.render(f), expected)) << lane.name << ", again";
    }
}

TEST_F(GpuTest, BricksLeaveNoSeam) {
    if (!gpu.device().features().nonuniform_textures) GTEST_SKIP();
    for (const std::string& name : SCENES) {
        Volume volume = sampled(name);
        double level = suggest_isovalue(volume, statistics(volume));
        auto whole = lanes(volume);
        auto bricked = lanes(volume, {.max_brick_side = 36});
        ASSERT_EQ(whole.size(), bricked.size());
        for (size_t lane = 0; lane < whole.size(); ++lane) {
            // Now and then a filtered sample is on another side of the isovalue in another brick.
            const uint64_t other =
                marches_filtered(whole[lane]) ? SIZE.width * SIZE.height / 1000 : 0;
            for (int index = 0; index < view_count(6); ++index) {
                Frame f = frame(view(volume, index), {level});
                expect_same(whole[lane].renderer.render(f), bricked[lane].renderer.render(f),
                            diagonal(volume),
                            fmt::format("{}, {}, view {}", whole[lane].name, name, index), other);
            }
            EXPECT_EQ(whole[lane].renderer.stats().bricks, 1u);
            EXPECT_GE(bricked[lane].renderer.stats().bricks, 4u);
        }
    }
}

TEST_F(GpuTest, RasterizersOfATechniqueAgree) {
    Volume volume = sampled(SCENES[1]);
    auto all = lanes(volume);
    for (size_t lane = 1; lane < all.size(); ++lane) {
        if (all[lane].options.technique != all[lane - 1].options.technique) continue;
        // Devices differ in the last bits of a triangle's depth; now and then that decides which
        // cell a hit is refined in. What direct's shader writes: rasterizer_test.cpp.
        const uint64_t other =
            all[lane].options.technique == "direct" ? SIZE.width * SIZE.height / 10000 : 0;
        for (int index = 0; index < view_count(6); ++index) {
            Frame f = frame(view(volume, index), {0});
            expect_same(all[lane].renderer.render(f), all[lane - 1].renderer.render(f),
                        diagonal(volume), fmt::format("{}, view {}", all[lane].name, index), other);
        }
    }
}

TEST_F(GpuTest, TechniquesAgree) {
    Volume volume = sampled("coral:96");
    double voxel = voxel_side(volume);
    auto all = lanes(volume);
    for (int index = 0; index < view_count(6); ++index) {
        Frame f = frame(view(volume, index), {0.5});
        Picture first = picture(all[0].renderer.render(f));
        for (size_t lane = 1; lane < all.size(); ++lane) {
            Agreement a = agreement(picture(all[lane].renderer.render(f)), first, 4 * voxel);
            EXPECT_GE(a.overlap, 0.998) << all[lane].name << ' ' << index;
            EXPECT_LE(a.depth_rms / voxel, 0.1) << all[lane].name << ' ' << index;
            EXPECT_LE(a.normal_degrees, 2) << all[lane].name << ' ' << index;
            EXPECT_EQ(a.holes, 0u) << all[lane].name << ' ' << index;
        }
    }
}

TEST_F(GpuTest, FormulasAreSampledAlikeOnBothSides) {
    for (std::string kind : {"sphere", "torus", "gyroid", "marschner-lobb", "noise", "coral",
                             "head", "vessels", "bone"}) {
        for (std::string type : {"u8", "u16", "f32"}) {
            Volume formula = make_procedural(kind + ":40x33x20:steps=7:type=" + type, 2);
            Volume voxels = make_procedural(formula.name, 2);
            sample(voxels);
            double step = type == "f32"
                              ? 1e-6
                              : formula.slope;  // a value between two steps may round either way
            auto here = statistics(voxels);
            auto range = Renderer(gpu, formula, {.technique = "raymarch"}).value_range();
            EXPECT_NEAR(range[0], here.minimum, 1.01 * step) << formula.name;
            EXPECT_NEAR(range[1], here.maximum, 1.01 * step) << formula.name;
            if (type != "f32") continue;
            double level = parse_isovalues("auto", formula).at(0);
            Frame f = frame(view(formula, 2), {level});
            Image a = Renderer(gpu, formula, {.technique = "raymarch"}).render(f);
            Image b = Renderer(gpu, voxels, {.technique = "raymarch"}).render(f);
            Agreement agreed = agreement(picture(a), picture(b), voxel_side(voxels));
            EXPECT_GE(agreed.overlap, 0.9995) << formula.name;
            EXPECT_LE(agreed.depth_rms / voxel_side(voxels), 1e-3) << formula.name;
        }
    }
}

// The same values in every voxel type, by slope and intercept, make the same picture, but for what
// a wide offset costs: 16-bit values near 32768 keep 8 bits behind the point.
TEST_F(GpuTest, VoxelTypesAreTheSameField) {
    std::array<uint32_t, 3> dims{40, 36, 32};
    auto of_type = [&]<typename Voxel>(VoxelType type, Voxel, double slope, double intercept) {
        Volume volume = volume_of<Voxel>(dims, type, [&](double i, double j, double k) {
            double value = std::floor(100 - 5 * std::hypot(i - 19, j - 18, k - 15));  // -56 to 100
            return (value - intercept) / slope;
        });
        volume.slope = slope;
        volume.intercept = intercept;
        return volume;
    };
    Volume floats = of_type(VoxelType::f32, float{}, 1, 0);
    std::vector<Volume> volumes;
    volumes.push_back(of_type(VoxelType::f64, double{}, 1, 0));
    volumes.push_back(of_type(VoxelType::i8, int8_t{}, 1, 0));
    volumes.push_back(of_type(VoxelType::i8, int8_t{}, -1, 10));
    volumes.push_back(of_type(VoxelType::u8, uint8_t{}, -1, 110));
    volumes.push_back(of_type(VoxelType::i16, int16_t{}, 0.25, 50));
    volumes.push_back(of_type(VoxelType::u16, uint16_t{}, -0.5, 300));
    volumes.push_back(of_type(VoxelType::i32, int32_t{}, 1, -1e6));
    volumes.push_back(of_type(VoxelType::u32, uint32_t{}, 0.5, -400));
    Frame f = frame(view(floats, 0), {30.5});
    auto expected = lanes(floats);
    for (const Volume& volume : volumes) {
        auto all = lanes(volume);
        for (size_t lane = 0; lane < all.size(); ++lane) {
            Agreement a = agreement(picture(all[lane].renderer.render(f)),
                                    picture(expected[lane].renderer.render(f)), 4);
            std::string what = fmt::format("{} {}", all[lane].name, name_of(volume.type));
            EXPECT_GE(a.overlap, marches_filtered(all[lane]) ? 0.99 : 0.9998) << what;
            EXPECT_LE(a.depth_rms, marches_filtered(all[lane]) ? 0.02
                                   : filters()                 ? 0.01
                                                               : 1e-3)
                << what;
            EXPECT_LE(a.normal_degrees, filters() ? 0.5 : 0.2) << what;
            EXPECT_EQ(a.holes, 0u) << what;
        }
    }
}

}  // namespace
