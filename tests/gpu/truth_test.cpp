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
    bool exact = false;  // ask for RendererOptions::exact
};

void PrintTo(const Scene& scene, std::ostream* out) {
    *out << scene.name;
}

// A neighbour that is further away lies on another part of the surface; see agreement().
constexpr double JUMP_VOXELS = 4;

void expect_agreement(const Agreement& a, double voxel, double overlap, const std::string& what) {
    EXPECT_GE(a.overlap, overlap) << what;
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
    auto all = lanes(volume, {.exact = scene.exact});
    for (int index = 0; index < view_count(20); ++index) {
        Camera camera = view(volume, index);
        Picture truth = voxels.render(camera, SIZE);
        Picture ideal = index < 4 ? formula.render(camera, SIZE) : Picture{};
        for (Lane& lane : all) {
            std::string what = fmt::format("{}, {}, view {}", lane.name, scene.name, index);
            Picture seen = picture(lane.renderer.render(frame(camera, {scene.level})));
            double jump = JUMP_VOXELS * voxel;
            expect_agreement(agreement(seen, truth, jump), voxel, 0.999, what);
            if (index < 4)
                expect_agreement(agreement(seen, ideal, jump), voxel, 0.99, what + ", formula");
        }
    }
}

// Marschner and Lobb's ridges hold slivers thinner than the half cell of a marching step, and are
// flat.
INSTANTIATE_TEST_SUITE_P(
    Scenes, Truth,
    testing::Values(Scene{"sphere:64", 0.25}, Scene{"torus:64", 0}, Scene{"gyroid:64", 0},
                    Scene{"marschner-lobb:320x320x90:type=u16", 0.5, /* exact= */ true},
                    Scene{"torus:64:type=u8", 0}, Scene{"sphere:64x64x32:spacing=1,1,2", 0.25},
                    Scene{"gyroid:96x60x96:spacing=1,1.6,1", 0}),
    [](const auto& scene) {
        std::string name = scene.param.name;
        std::replace_if(name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
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
                             1, 0.999, fmt::format("{}, view {}", lane.name, index));
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
                             voxel, 0.999, fmt::format("{}, view {}", lane.name, index));
    }
}

// The exact option is the reference on the GPU: the caster's own first hits, in single precision.
TEST_F(GpuTest, ExactMarchingIsTheCaster) {
    Volume smooth = sampled("marschner-lobb:64"), rough = random_blob(48, 1);
    for (const Volume* volume : {&smooth, &rough}) {
        double level = volume == &rough ? 99.5 : 0.5, voxel = voxel_side(*volume);
        TrilinearCaster voxels(*volume, {level});
        auto all = lanes(*volume, {.exact = true});
        auto is_exact = [](const Lane& lane) { return lane.options.exact; };
        EXPECT_TRUE(std::any_of(all.begin(), all.end(), is_exact));
        for (int index = 0; index < view_count(6); ++index) {
            Camera camera = view(*volume, index);
            Picture truth = voxels.render(camera, SIZE);
            for (Lane& lane : all) {
                if (!is_exact(lane)) continue;
                Agreement a =
                    agreement(picture(lane.renderer.render(frame(camera, {level}))), truth, voxel);
                std::string what = fmt::format("{}, {}, view {}", lane.name, volume->name, index);
                EXPECT_GE(a.overlap, 0.9995) << what;
                EXPECT_LE(a.depth_rms / voxel, 0.01) << what;
                EXPECT_LE(a.normal_degrees, 1) << what;
                EXPECT_EQ(a.holes, 0u) << what;
            }
        }
    }
}

}  // namespace
