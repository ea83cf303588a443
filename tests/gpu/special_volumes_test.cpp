// SPDX-License-Identifier: MIT
// Volumes and isovalues at the edge of what is defined: each has one documented picture.
#include "gpu/device.h"
#include "gpu/gpu_fixture.h"
#include "reference/trilinear.h"

namespace {

using namespace isorast;
using namespace reference;

uint64_t covered(const Image& image) {
    return uint64_t(std::count_if(image.depth.begin(), image.depth.end(),
                                  [](float d) { return std::isfinite(d); }));
}

float ball(double i, double j, double k) {
    return float(10 - std::hypot(i - 11.5, j - 11.5, k - 11.5));
}
constexpr std::array<uint32_t, 3> BALL{24, 24, 24};

TEST_F(GpuTest, AConstantVolumeIsEmpty) {
    for (auto type : {VoxelType::u8, VoxelType::f32}) {
        auto seven = [](double, double, double) { return 7; };
        Volume volume = type == VoxelType::u8 ? volume_of<uint8_t>({20, 20, 20}, type, seven)
                                              : volume_of<float>({20, 20, 20}, type, seven);
        for (Lane& lane : lanes(volume))
            for (double isovalue : {6.0, 7.0, 8.0})
                EXPECT_EQ(covered(lane.renderer.render(frame(orbit(volume, 30, 20), {isovalue}))),
                          0u)
                    << lane.name << ' ' << isovalue;
    }
}

TEST_F(GpuTest, AnIsovalueOutsideTheRangeIsEmpty) {
    Volume floats = volume_of<float>(BALL, VoxelType::f32, ball);
    Volume bytes = sampled("sphere:24:type=u8");
    for (const Volume* volume : {&floats, &bytes})
        for (Lane& lane : lanes(*volume))
            for (double isovalue : {-1e30, -100.0, 11.0, 1e5, 1e30})
                EXPECT_EQ(covered(lane.renderer.render(frame(orbit(*volume, 30, 20), {isovalue}))),
                          0u)
                    << lane.name << ' ' << isovalue;
}

// Cells need two voxels along each axis.
TEST_F(GpuTest, AVolumeOneVoxelThinIsEmptyAndTwoIsNot) {
    for (uint32_t thin = 0; thin < 3; ++thin) {
        std::array<uint32_t, 3> dims{24, 24, 24};
        for (uint32_t side : {1u, 2u}) {
            dims[thin] = side;
            Volume volume = volume_of<float>(dims, VoxelType::f32, ball);
            double middle =
                ball(thin == 0 ? 0 : 11.5, thin == 1 ? 0 : 11.5, thin == 2 ? 0 : 11.5) - 3;
            for (Lane& lane : lanes(volume)) {
                uint64_t pixels =
                    covered(lane.renderer.render(frame(orbit(volume, 30, 40), {middle})));
                EXPECT_EQ(pixels > 0, side == 2)
                    << lane.name << " axis " << thin << " side " << side;
            }
        }
    }
}

// Bricks in the middle are a voxel longer than the first one; here each is uploaded in one piece.
TEST_F(GpuTest, AThinVolumeOfManyBricks) {
    if (!gpu.device().features().nonuniform_textures) GTEST_SKIP();
    for (const uint32_t side : {1u, 2u}) {
        const Volume volume = volume_of<float>({60, 16, side}, VoxelType::f32, ball);
        const Frame f = frame(orbit(volume, 30, 40), {ball(15, 8, 0)});
        Renderer whole(gpu, volume), bricked(gpu, volume, {.max_brick_side = 20});
        const Image image = bricked.render(f);
        EXPECT_EQ(bricked.stats().bricks, 4u);
        EXPECT_EQ(covered(image) > 0, side == 2);
        EXPECT_EQ(covered(image), covered(whole.render(f)));
    }
}

// The same picture, whatever the units of lengths and of values: powers of two, so that all else is
// exactly the same.
TEST_F(GpuTest, UnitsDoNotMatter) {
    const auto in_units = [](double length, float value) {
        Volume volume = volume_of<float>(
            {24, 24, 24}, VoxelType::f32,
            [=](uint32_t i, uint32_t j, uint32_t k) { return value * float(ball(i, j, k)); });
        for (auto& row : volume.affine.m)
            for (double& entry : row)
                entry *= length;
        return volume;
    };
    const Volume plain = in_units(1, 1);
    const double level = ball(2, 11, 11);
    std::vector<Lane> lanes_of_plain = lanes(plain);
    for (const auto& [length, value] :
         {std::pair(0x1p-66, 1.0f), {0x1p66, 1.0f}, {1.0, 0x1p-90f}, {1.0, 0x1p90f}}) {
        const Volume volume = in_units(length, value);
        std::vector<Lane> others = lanes(volume);
        for (size_t lane = 0; lane < others.size(); ++lane) {
            const Image expected =
                lanes_of_plain[lane].renderer.render(frame(orbit(plain, 30, 40), {level}));
            const Image found =
                others[lane].renderer.render(frame(orbit(volume, 30, 40), {level * value}));
            EXPECT_GT(covered(expected), 1000u);
            EXPECT_EQ(found.rgba, expected.rgba)
                << others[lane].name << ' ' << length << ' ' << value;
            for (size_t i = 0; i < found.depth.size(); i += 97)
                EXPECT_EQ(double(found.depth[i]), double(expected.depth[i]) * length);
        }
    }
}

TEST_F(GpuTest, WithoutIsovaluesThereIsNothing) {
    const Volume volume = reference::sampled("sphere:24");
    for (Lane& lane : lanes(volume))
        for (const bool culling : {true, false}) {
            Frame f = frame(orbit(volume, 30, 40), {});
            f.culling = culling;
            lane.renderer.render(frame(orbit(volume, 30, 40), {0.0}));
            EXPECT_EQ(covered(lane.renderer.render(f)), 0u) << lane.name;
        }
}

// More bricks than one, and a pyramid of 13 levels.
TEST_F(GpuTest, AVeryLongVolume) {
    if (!gpu.device().features().nonuniform_textures) GTEST_SKIP();
    Volume volume = volume_of<uint8_t>(
        {20000, 3, 3}, VoxelType::u8,
        [](uint32_t i, uint32_t j, uint32_t k) { return (i / 4 * 37 + 60 * j + 20 * k) % 256; });
    Frame f = frame(orbit(volume, 10, 30, {.zoom = 400}), {100.0});
    std::vector<Lane> all = lanes(volume);
    const Image first = all.front().renderer.render(f);
    for (Lane& lane : all) {
        const Image other = lane.renderer.render(f);
        uint64_t hits = 0, differ = 0;
        for (size_t i = 0; i < first.depth.size(); ++i) {
            hits += std::isfinite(first.depth[i]);
            differ += std::isfinite(first.depth[i]) != std::isfinite(other.depth[i]);
        }
        EXPECT_GT(hits, 200u) << lane.name;
        EXPECT_LE(differ, hits / 20) << lane.name;
    }
}

// More blocks than a row of workgroups: each of 33024 quartets of blocks holds a bump, and each
// shows.
TEST_F(GpuTest, MoreBlocksThanARowOfWorkgroups) {
    if (std::getenv("ISORAST_QUICK")) GTEST_SKIP();  // half a minute
    const Volume volume =
        volume_of<uint8_t>({4096, 2057, 9}, VoxelType::u8, [](uint32_t i, uint32_t j, uint32_t k) {
            return k == 4 && (i % 16 + 15) % 16 < 6 && (j % 16 + 15) % 16 < 6 ? 255 : 0;
        });
    Frame f = frame(*view_preset(volume, "+z", {.orthographic = true}), {128.0});
    f.size = {1024, 514};
    f.camera.height = 2056;  // 4 voxels a pixel
    f.shading = Shading::depth;
    for (Lane& lane : lanes(volume)) {
        if (lane.options.technique != "direct") continue;
        for (bool culling : {false, true}) {
            f.culling = culling;
            const Image image = lane.renderer.render(f);
            std::vector<bool> shows(size_t{256} * 129);
            for (size_t i = 0; i < image.depth.size(); ++i)
                if (std::isfinite(image.depth[i]))
                    shows[i % 1024 / 4 + 256 * (i / 1024 / 4)] = true;
            EXPECT_EQ(std::ranges::count(shows, false), 0) << lane.name << ' ' << culling;
            EXPECT_EQ(lane.renderer.stats().blocks_drawn, 33024u);
        }
    }
}

TEST_F(GpuTest, TheSmallestVolumes) {
    for (std::array<uint32_t, 3> dims : {std::array<uint32_t, 3>{1, 1, 1}, {2, 1, 1}, {2, 2, 2}}) {
        Volume volume = volume_of<uint8_t>(dims, VoxelType::u8,
                                           [](double i, double, double) { return 200 * i; });
        for (Lane& lane : lanes(volume)) {
            uint64_t pixels = covered(lane.renderer.render(frame(orbit(volume, 60, 20), {100})));
            EXPECT_EQ(pixels > 0, dims[2] == 2)
                << lane.name << ' ' << dims[0] << dims[1] << dims[2];
        }
    }
}

// Outside, whatever the isovalue: so a hole in a ball, of which the rest stays as it was.
TEST_F(GpuTest, VoxelsThatAreNotFiniteAreOutside) {
    for (float bad : {std::nanf(""), float(INFINITE), -float(INFINITE)}) {
        Volume volume = volume_of<float>(BALL, VoxelType::f32, [&](double i, double j, double k) {
            return i > 9 && i < 14 && j > 9 && j < 14 ? bad : ball(i, j, k);
        });
        Volume whole = volume_of<float>(BALL, VoxelType::f32, ball);
        Volume outside = volume_of<float>(BALL, VoxelType::f32, [&](double i, double j, double k) {
            return i > 9 && i < 14 && j > 9 && j < 14 ? -1e30f : ball(i, j, k);
        });
        Frame along = frame(orbit(volume, 0, 90), {2}), aside = frame(orbit(volume, 40, 10), {2});
        Picture truth = TrilinearCaster(whole, {2}).render(aside.camera, SIZE);
        auto all = lanes(volume), low = lanes(outside);
        for (size_t lane = 0; lane < all.size(); ++lane) {
            Image image = all[lane].renderer.render(along);
            EXPECT_FALSE(std::isfinite(image.depth[SIZE.height / 2 * SIZE.width + SIZE.width / 2]))
                << all[lane].name << ' ' << bad;
            Agreement a = agreement(picture(all[lane].renderer.render(aside)), truth, 4);
            EXPECT_GE(a.overlap, 0.99) << all[lane].name << ' ' << bad;
            // As if they held a very low value.
            Agreement b = agreement(picture(image), picture(low[lane].renderer.render(along)), 4);
            EXPECT_GE(b.overlap, 0.999) << all[lane].name << ' ' << bad;
            EXPECT_LE(b.depth_rms, 0.1) << all[lane].name << ' ' << bad;
            auto range = all[lane].renderer.value_range();
            EXPECT_TRUE(std::isfinite(range[0]) && std::isfinite(range[1])) << all[lane].name;
        }
    }
}

// Each way ends the surface at the last finite voxels. Between those and others is nothing, not
// even rounding errors of the lowest floats; marching cubes cut a corner there.
TEST_F(GpuTest, NothingIsBetweenVoxelsThatAreNotFinite) {
    for (const bool scattered : {false, true}) {
        const Volume volume = volume_of<float>(BALL, VoxelType::f32, [&](int i, int j, int k) {
            const bool bad = scattered ? (i * 7 + j * 5 + k * 3) % 61 == 0 : i < 8;
            return bad ? std::nanf("") : ball(i, j, k);
        });
        const Frame f = frame(orbit(volume, 200, 25), {2});
        Renderer direct(gpu, volume, {.technique = "direct", .rasterizer = Rasterizer::compute});
        const Picture expected = picture(direct.render(f));
        for (Lane& lane : lanes(volume, {.exact = true})) {
            const Picture found = picture(lane.renderer.render(f));
            uint32_t beyond = 0;
            for (size_t i = 0; i < found.hits.size(); ++i)
                beyond +=
                    std::isfinite(found.hits[i].depth) && !std::isfinite(expected.hits[i].depth);
            EXPECT_LE(beyond, 20u) << lane.name << ' ' << scattered;
            if (scattered) continue;
            const Agreement a = agreement(found, expected, 1);
            EXPECT_GE(a.overlap, 0.99) << lane.name;
            EXPECT_LE(a.depth_rms, 0.1) << lane.name;
        }
    }
}

TEST_F(GpuTest, NoFiniteVoxelAtAllIsEmpty) {
    Volume volume = volume_of<float>({12, 12, 12}, VoxelType::f32,
                                     [](double, double, double) { return std::nanf(""); });
    for (Lane& lane : lanes(volume))
        EXPECT_EQ(covered(lane.renderer.render(frame(orbit(volume, 30, 20), {0}))), 0u)
            << lane.name;
}

// Each pixel shows the nearest surface, in that surface's colour.
TEST_F(GpuTest, SeveralIsovalues) {
    Volume volume = sampled("gyroid:64");
    const std::vector<double> isovalues{0.6, -0.9, 0};
    const std::vector<Color> colors{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
    double voxel = voxel_side(volume);
    TrilinearCaster voxels(volume, isovalues);
    for (Lane& lane : lanes(volume)) {
        for (int index : {0, 1, 2}) {
            std::string what = fmt::format("{}, view {}", lane.name, index);
            Frame f = frame(view(volume, index), isovalues);
            Agreement a = agreement(picture(lane.renderer.render(f)), voxels.render(f.camera, SIZE),
                                    4 * voxel);
            EXPECT_GE(a.overlap, 0.999) << what;
            EXPECT_LE(a.depth_rms / voxel, 0.1) << what;
            EXPECT_EQ(a.holes, 0u) << what;

            f.shading = Shading::gooch;
            f.colors = colors;
            Image together = lane.renderer.render(f);
            std::vector<Image> alone;
            for (size_t surface = 0; surface < isovalues.size(); ++surface) {
                Frame one = f;
                one.isovalues = {isovalues[surface]};
                one.colors = {colors[surface]};
                alone.push_back(lane.renderer.render(one));
            }
            uint64_t compared = 0, wrong = 0;
            for (size_t i = 0; i < together.depth.size(); ++i) {
                auto nearest = std::min_element(
                    alone.begin(), alone.end(),
                    [&](const Image& x, const Image& y) { return x.depth[i] < y.depth[i]; });
                if (!std::isfinite(nearest->depth[i])) continue;
                ++compared;
                bool same = std::abs(together.depth[i] - nearest->depth[i]) < 0.01 * voxel;
                for (size_t c = 0; c < 4; ++c)
                    same =
                        same && std::abs(together.rgba[4 * i + c] - nearest->rgba[4 * i + c]) <= 2;
                wrong += !same;
            }
            EXPECT_GT(compared, 20000u) << what;
            EXPECT_LE(wrong, compared / 1000) << what;
        }
    }
}

// The core, 100 everywhere, is inside at the isovalue 100: no ray may pass through the random shell
// around it.
TEST_F(GpuTest, RandomVoxelsAtTheIsovalueAreWatertight) {
    for (uint32_t seed : {1u, 2u}) {
        Volume blob = random_blob(48, seed), core = solid_core(48);
        TrilinearCaster voxels(core, {100});
        auto all = lanes(blob);
        for (int index = 0; index < view_count(10); ++index) {
            Camera camera = view(blob, index);
            Picture truth = voxels.render(camera, SIZE);
            for (Lane& lane : all) {
                Agreement a =
                    agreement(picture(lane.renderer.render(frame(camera, {100}))), truth, 4);
                EXPECT_EQ(a.holes, 0u) << lane.name << ' ' << index;
                EXPECT_GT(a.covered, 1000u);
            }
        }
    }
}

}  // namespace
