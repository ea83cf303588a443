// SPDX-License-Identifier: MIT
// Every technique, in every scene, from many sides: against a ray caster in double precision on the
// same voxels, and against the formula itself where the error of sampling it is small enough.
#include "gpu/gpu_fixture.h"
#include "reference/formula.h"
#include "reference/trilinear.h"

namespace {

using namespace isorast;
using namespace reference;

struct Scene {
    std::string name;
    double level;
    bool smooth;  // sampled finely enough to be held against its formula
};

void PrintTo(const Scene& scene, std::ostream* out) {
    *out << scene.name;
}

// A neighbour that is further away lies on another part of the surface; see agreement().
constexpr double JUMP_VOXELS = 4;

void expect_agreement(const Agreement& a, double voxel, const std::string& what) {
    EXPECT_GE(a.overlap, 0.999) << what;
    EXPECT_LE(a.depth_rms / voxel, 0.1) << what;
    EXPECT_LE(a.normal_degrees, 2) << what;
    EXPECT_EQ(a.holes, 0u) << what;
    EXPECT_GT(a.measured, a.covered / 4) << what;
}

class Truth : public GpuTest, public testing::WithParamInterface<Scene> {};

TEST_P(Truth, FromManySides) {
    const Scene& scene = GetParam();
    Volume volume = sampled(scene.name);
    double voxel = voxel_side(volume);
    TrilinearCaster voxels(volume, {scene.level});
    FormulaCaster formula(volume);
    auto all = lanes(volume);
    for (int index = 0; index < view_count(20); ++index) {
        Camera camera = view(volume, index);
        Picture truth = voxels.render(camera, SIZE);
        bool hold_against_formula = scene.smooth && index < 4;
        Picture ideal = hold_against_formula ? formula.render(camera, SIZE) : Picture{};
        for (Lane& lane : all) {
            std::string what = fmt::format("{}, {}, view {}", lane.name, scene.name, index);
            Picture seen = picture(lane.renderer.render(frame(camera, {scene.level})));
            expect_agreement(agreement(seen, truth, JUMP_VOXELS * voxel), voxel, what);
            if (!hold_against_formula) continue;
            Agreement a = agreement(seen, ideal, JUMP_VOXELS * voxel);
            EXPECT_GE(a.overlap, 0.995) << what << ", formula";
            EXPECT_LE(a.depth_rms / voxel, 0.1) << what << ", formula";
            EXPECT_LE(a.normal_degrees, 2) << what << ", formula";
            EXPECT_EQ(a.holes, 0u) << what << ", formula";
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Truth,
                         testing::Values(Scene{"sphere:64", 0.25, true}, Scene{"torus:64", 0, true},
                                         Scene{"gyroid:64", 0, true},
                                         Scene{"marschner-lobb:256x256x72:type=u16", 0.5, false},
                                         Scene{"torus:64:type=u8", 0, false},
                                         Scene{"sphere:64x64x32:spacing=1,1,2", 0.25, true},
                                         Scene{"gyroid:96x60x96:spacing=1,1.6,1", 0, true}),
                         [](const auto& scene) {
                             std::string name = scene.param.name;
                             std::replace_if(
                                 name.begin(), name.end(), [](char c) { return !std::isalnum(c); },
                                 '_');
                             return name;
                         });

// Oblique axes, shear and mirroring: the world, not the grid, is what is seen.
TEST_F(GpuTest, ObliqueShearedAndMirrored) {
    Volume volume = sampled("torus:64");
    volume.affine.m = {{{0.8, 0.5, 0.1, 10}, {-0.6, 1.1, 0.2, -3}, {0.1, 0.3, -1.4, 50}}};
    ASSERT_LT(volume.affine.determinant(), 0);
    TrilinearCaster voxels(volume, {0});
    auto all = lanes(volume);
    for (int index = 0; index < view_count(8); ++index) {
        Camera camera = view(volume, index);
        Picture truth = voxels.render(camera, SIZE);
        for (Lane& lane : all)
            expect_agreement(agreement(picture(lane.renderer.render(frame(camera, {0}))), truth, 4),
                             1, fmt::format("{}, view {}", lane.name, index));
    }
}

TEST_F(GpuTest, EyeInsideTheVolume) {
    Volume volume = sampled("gyroid:64");
    double voxel = voxel_side(volume);
    TrilinearCaster voxels(volume, {0});
    auto all = lanes(volume);
    for (int index = 0; index < view_count(4); ++index) {
        Camera camera = view(volume, 3 * index);  // perspective
        camera.position = {0.05, -0.02, 0.04};
        camera.target = {std::cos(index), std::sin(index), 0.3};
        camera.up = {0, 0, 1};
        camera.fov_degrees = 70;
        Picture truth = voxels.render(camera, SIZE);
        for (Lane& lane : all)
            expect_agreement(agreement(picture(lane.renderer.render(frame(camera, {0}))), truth,
                                       JUMP_VOXELS * voxel),
                             voxel, fmt::format("{}, view {}", lane.name, index));
    }
}

// The exact option is the reference on the GPU: the caster's own first hits, in single precision.
TEST_F(GpuTest, ExactMarchingIsTheCaster) {
    Volume smooth_volume = sampled("marschner-lobb:64"), rough = random_blob(48, 1);
    for (const Volume* volume : {&smooth_volume, &rough}) {
        double level = volume == &rough ? 99.5 : 0.5, voxel = voxel_side(*volume);
        TrilinearCaster voxels(*volume, {level});
        for (auto rasterizer : {Rasterizer::hardware, Rasterizer::compute}) {
            Renderer renderer(gpu, *volume,
                              {.technique = "raymarch", .rasterizer = rasterizer, .exact = true});
            for (int index = 0; index < view_count(6); ++index) {
                Camera camera = view(*volume, index);
                Agreement a = agreement(picture(renderer.render(frame(camera, {level}))),
                                        voxels.render(camera, SIZE), voxel);
                std::string what =
                    fmt::format("{}, {}, view {}", volume->name, name_of(rasterizer), index);
                EXPECT_GE(a.overlap, 0.9995) << what;
                EXPECT_LE(a.depth_rms / voxel, 0.01) << what;
                EXPECT_LE(a.normal_degrees, 1) << what;
                EXPECT_EQ(a.holes, 0u) << what;
            }
        }
    }
}

}  // namespace
