// SPDX-License-Identifier: MIT
// The renderers that serve as truth, against each other and against what can be worked out by hand.
#include <gtest/gtest.h>

#include "reference/agreement.h"
#include "reference/formula.h"
#include "reference/scenes.h"
#include "reference/trilinear.h"

namespace {

using namespace isorast;
using namespace reference;

constexpr Size SIZE{240, 180};

TEST(Reference, CubicCrossings) {
    bool inside = false;
    EXPECT_NEAR(*first_crossing({-0.25, 1, 0, 0}, inside), 0.25, 1e-15);
    Cubic three_roots{-0.06 * 0.9, 0.06 + 0.9 * 0.5, -0.5 - 0.9, 1};  // (u - 0.2)(u - 0.3)(u - 0.9)
    EXPECT_NEAR(*first_crossing(three_roots, inside), 0.2, 1e-12);
    Cubic twin{-0.25, 1, -1, 0};  // touches zero at 0.5 from below
    EXPECT_NEAR(*first_crossing(twin, inside), 0.5, 1e-7);
    EXPECT_FALSE(first_crossing({-1, 0.5, 0, 0}, inside));
    EXPECT_EQ(first_crossing({1, 0, 0, 0}, inside), 0);  // the cell before ended outside
    inside = true;
    EXPECT_NEAR(*first_crossing({0.5, 0, -2, 0}, inside), 0.5, 1e-12);
}

// A field v = i is a plane, whatever the affine does to it.
TEST(Reference, PlaneThroughAShearedAffine) {
    Volume volume =
        volume_of<float>({12, 10, 9}, VoxelType::f32, [](double i, double, double) { return i; });
    volume.affine.m = {{{1, 0.3, 0.1, 5}, {-0.2, 2, 0.4, -7}, {0.1, 0.2, -3, 2}}};
    TrilinearCaster caster(volume, {5.3});
    dvec3 on_plane = vector(volume.affine(5.3, 4, 4));
    dvec3 along_j = vector(volume.affine(0, 1, 0)) - vector(volume.affine(0, 0, 0));
    dvec3 along_k = vector(volume.affine(0, 0, 1)) - vector(volume.affine(0, 0, 0));
    dvec3 normal = glm::normalize(glm::cross(along_j, along_k));
    Camera camera = orbit(volume, 60, 20);
    Picture picture = caster.render(camera, SIZE);
    Rays rays(camera, SIZE);
    int hits = 0;
    for (uint32_t y = 0; y < SIZE.height; ++y)
        for (uint32_t x = 0; x < SIZE.width; ++x) {
            const Hit& hit = picture.at(x, y);
            if (hit.depth == INFINITE) continue;
            Ray ray = rays.through(x + 0.5, y + 0.5);
            double expected =
                glm::dot(on_plane - ray.origin, normal) / glm::dot(ray.direction, normal);
            EXPECT_NEAR(hit.depth, expected, 1e-9);
            EXPECT_NEAR(std::abs(glm::dot(hit.normal, normal)), 1, 1e-9);
            EXPECT_LT(glm::dot(hit.normal, ray.direction), 0);
            ++hits;
        }
    EXPECT_GT(hits, 1000);
}

// Tiny steps through the interpolated field find the same first crossing.
TEST(Reference, FirstHitOnRandomVoxels) {
    Volume volume = random_blob(20, 5);
    for (double isovalue : {100.0, 99.5, 177.0}) {
        TrilinearCaster caster(volume, {isovalue});
        Camera camera = orbit(volume, 31, 17);
        Rays rays(camera, SIZE);
        Picture picture = caster.render(camera, SIZE);
        int compared = 0;
        for (uint32_t y = 20; y < 100; y += 5)
            for (uint32_t x = 20; x < 140; x += 5) {
                Ray ray = rays.through(x + 0.5, y + 0.5);
                auto range = clip(ray, dvec3(19));
                if (!range) continue;
                double depth = INFINITE;
                for (double t = range->first; t < range->second && depth == INFINITE; t += 1e-3)
                    if (caster.value(ray.at(t)) >= isovalue) depth = t;
                // Steps may jump over a sliver, and then find something later.
                EXPECT_LE(picture.at(x, y).depth, depth + 1e-9);
                if (depth != INFINITE && picture.at(x, y).depth > depth - 2e-3) ++compared;
            }
        EXPECT_GT(compared, 50) << isovalue;
    }
}

TEST(Reference, TheNearestOfSeveralIsovaluesIsSeen) {
    Volume volume = sampled("sphere:32");
    Camera camera = orbit(volume, 0, 0);
    Picture both = TrilinearCaster(volume, {0.5, 0.25}).render(camera, SIZE);
    Picture outer = TrilinearCaster(volume, {0.25}).render(camera, SIZE);
    EXPECT_EQ(agreement(both, outer, INFINITE).depth_rms, 0);
    EXPECT_EQ(agreement(both, outer, INFINITE).overlap, 1);
}

struct Case {
    std::string name;
    double level, overlap, depth_voxels, normal_degrees;
};

// What trilinear interpolation between samples costs, and no more.
TEST(Reference, VoxelsAgreeWithTheFormula) {
    const std::vector<Case> cases{
        {"sphere:64", 0.25, 0.995, 0.02, 0.2},
        {"sphere:64x64x32:spacing=1,1,2", 0.25, 0.995, 0.06, 0.6},
        {"torus:96", 0, 0.995, 0.03, 0.5},
        {"gyroid:64", 0, 0.995, 0.1, 1.5},
        {"gyroid:40x64x24:spacing=1,1,2", 0, 0.995, 0.2, 3},
        {"marschner-lobb:256", 0.5, 0.995, 0.3, 4},
    };
    for (const Case& c : cases) {
        Volume volume = sampled(c.name);
        TrilinearCaster voxels(volume, {c.level});
        FormulaCaster formula(volume);
        double voxel = voxel_side(volume);
        for (int index : {0, 1, 2, 3}) {
            Camera camera = view(volume, index);
            Agreement a =
                agreement(voxels.render(camera, SIZE), formula.render(camera, SIZE), 4 * voxel);
            EXPECT_GE(a.overlap, c.overlap) << c.name << ' ' << index;
            EXPECT_LE(a.depth_rms, c.depth_voxels * voxel) << c.name << ' ' << index;
            EXPECT_LE(a.normal_degrees, c.normal_degrees) << c.name << ' ' << index;
            EXPECT_EQ(a.holes, 0u) << c.name << ' ' << index;
            EXPECT_GT(a.measured, a.covered / 20) << c.name << ' ' << index;
        }
    }
}

TEST(Reference, VoxelsThatAreNotFiniteAreEmpty) {
    Volume volume =
        volume_of<float>({24, 24, 24}, VoxelType::f32, [](double i, double j, double k) {
            if (i == 12 && j == 12) return std::nan("");
            return 10 - std::hypot(i - 11.5, j - 11.5, k - 11.5);
        });
    Picture picture = TrilinearCaster(volume, {2.0}).render(orbit(volume, 0, 90), SIZE);
    EXPECT_EQ(picture.at(SIZE.width / 2, SIZE.height / 2).depth,
              INFINITE);  // straight down the hole
    EXPECT_NE(picture.at(SIZE.width / 2 - 20, SIZE.height / 2).depth, INFINITE);
}

}  // namespace
