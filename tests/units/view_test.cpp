// SPDX-License-Identifier: MIT
// What shaders are told of a frame: each eye's projection and rays are each other's inverse, both
// eyes meet at the distance of convergence, and clip planes cut where the world says.
#include "image/view.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_inverse.hpp>
#include <random>

#include "image/stereo.h"

namespace {

using namespace isorast;
using glm::dvec3;
using glm::dvec4;

struct Scene {
    Volume volume = make_procedural("sphere:40x30x20:spacing=1,2,1.5");
    Placement placement{volume.affine, volume.dims};
    Stored stored;
    std::mt19937 random{3};

    dvec3 point() {  // voxel space
        const auto side = [&](int i) {
            return std::uniform_real_distribution(0.0, volume.dims[i] - 1.0)(random);
        };
        return {side(0), side(1), side(2)};
    }
    Frame frame(bool orthographic, StereoMode mode) {
        Frame f;
        f.isovalues = {0.5};
        f.camera = orbit(volume, 40, 25, {.orthographic = orthographic});
        f.size = {320, 200};
        f.stereo.mode = mode;
        return f;
    }
    shared::FrameInfo info(const Frame& f) { return make_frame_info(f, placement, stored); }
};

dvec3 project(const shared::EyeInfo& eye, const dvec3& p) {
    const dvec4 clip = glm::dmat4(eye.clip_from_voxel) * dvec4(p, 1);
    return dvec3(clip) / clip.w;
}

TEST(View, RaysGoThroughWhatTheyShow) {
    Scene scene;
    for (bool orthographic : {false, true})
        for (StereoMode mode : {StereoMode::off, StereoMode::layers}) {
            const Frame f = scene.frame(orthographic, mode);
            const auto info = scene.info(f);
            for (uint32_t e = 0; e < f.eyes(); ++e)
                for (int i = 0; i < 50; ++i) {
                    const auto& eye = info.eyes[e];
                    const dvec3 p = scene.point(), ndc = project(eye, p);
                    const dvec3 origin = dvec3(eye.ray_origin) + ndc.x * dvec3(eye.ray_origin_x) +
                                         ndc.y * dvec3(eye.ray_origin_y);
                    const dvec3 way = dvec3(eye.ray_direction) +
                                      ndc.x * dvec3(eye.ray_direction_x) +
                                      ndc.y * dvec3(eye.ray_direction_y);
                    const double t = glm::dot(p - origin, way) / glm::dot(way, way);
                    EXPECT_LT(glm::length(origin + t * way - p), 1e-3) << orthographic << e;
                    // t is view depth, and depth runs from 1 at the near plane to 0.
                    const double near = info.depth_range.x, far = info.depth_range.y;
                    const double depth = orthographic ? (far - t) / (far - near)
                                                      : (near * far / t - near) / (far - near);
                    EXPECT_NEAR(ndc.z, depth, 1e-5);
                }
        }
}

TEST(View, EyesMeetAtTheDistanceOfConvergence) {
    Scene scene;
    for (bool orthographic : {false, true}) {
        Frame f = scene.frame(orthographic, StereoMode::layers);
        const dvec3 eye(f.camera.position[0], f.camera.position[1], f.camera.position[2]);
        const dvec3 target(f.camera.target[0], f.camera.target[1], f.camera.target[2]);
        const double distance = glm::length(target - eye);
        f.stereo.convergence = 0.9 * distance;
        f.stereo.separation = 0.1 * distance;
        const auto info = scene.info(f);
        const glm::dmat4 voxel = glm::inverse([&] {
            glm::dmat4 m(1);
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 4; ++column)
                    m[column][row] = scene.volume.affine.m[row][column];
            return m;
        }());
        const auto parallax = [&](double depth) {  // how much further right the right eye sees it
            const dvec3 p = voxel * dvec4(eye + depth / distance * (target - eye), 1);
            EXPECT_NEAR(project(info.eyes[0], p).z, project(info.eyes[1], p).z, 1e-6);
            EXPECT_NEAR(project(info.eyes[0], p).y, project(info.eyes[1], p).y, 1e-6);
            return project(info.eyes[1], p).x - project(info.eyes[0], p).x;
        };
        EXPECT_NEAR(parallax(0.9 * distance), 0, 1e-5);
        EXPECT_LT(parallax(0.8 * distance), -1e-3);  // nearer: the right eye sees it further left
        EXPECT_GT(parallax(1.0 * distance), 1e-3);
    }
}

TEST(View, ClipPlanesCutWhereTheWorldSays) {
    Scene scene;
    for (bool orthographic : {false, true}) {
        Frame f = scene.frame(orthographic, StereoMode::layers);
        f.clips = {{.normal = {1, 2, -2}, .offset = 0.3}, {.normal = {0, -1, 0}, .offset = -2}};
        const auto info = scene.info(f);
        for (int i = 0; i < 200; ++i) {
            const dvec3 p = scene.point();
            const auto world = scene.volume.affine(p.x, p.y, p.z);
            for (size_t c = 0; c < f.clips.size(); ++c) {
                const auto& n = f.clips[c].normal;
                const double side =
                    n[0] * world[0] + n[1] * world[1] + n[2] * world[2] - f.clips[c].offset;
                if (std::abs(side) < 1e-3) continue;
                EXPECT_EQ(glm::dot(dvec4(info.clips[c]), dvec4(p, 1)) > 0, side > 0);
                for (const auto& eye : info.eyes)
                    EXPECT_EQ(glm::dot(dvec4(eye.clips[c]), dvec4(project(eye, p), 1)) > 0,
                              side > 0);
            }
        }
    }
}

TEST(Stereo, LayersAreArranged) {
    Image layers{.size = {2, 4}, .rgba = {}, .depth = {1, 2, 3, 4, 5, 6, 7, 8}};
    for (uint8_t i = 0; i < 8; ++i)
        for (int c = 0; c < 4; ++c)
            layers.rgba.push_back(c == 3 ? 255 : uint8_t(10 * i));
    const Image beside = arrange(layers, StereoMode::side_by_side);
    EXPECT_EQ(beside.size, (Size{4, 2}));
    EXPECT_EQ(beside.depth, (std::vector<float>{1, 2, 5, 6, 3, 4, 7, 8}));
    EXPECT_EQ(beside.pixel(2, 1)[0], 60);
    EXPECT_EQ(arrange(layers, StereoMode::layers).rgba, layers.rgba);
    // White stays white, black stays black, and each eye's white comes through its own filter.
    const Image white{.size = {1, 2}, .rgba = {255, 255, 255, 255, 255, 255, 255, 255}};
    for (uint8_t channel : arrange(white, StereoMode::anaglyph).rgba)
        EXPECT_GE(channel, 250);
    const Image left{.size = {1, 2}, .rgba = {255, 255, 255, 255, 0, 0, 0, 255}};
    const Image right{.size = {1, 2}, .rgba = {0, 0, 0, 255, 255, 255, 255, 255}};
    EXPECT_GT(arrange(left, StereoMode::anaglyph).rgba[0], 240);
    EXPECT_LT(arrange(left, StereoMode::anaglyph).rgba[1], 10);
    EXPECT_LT(arrange(right, StereoMode::anaglyph).rgba[0], 10);
    EXPECT_GT(arrange(right, StereoMode::anaglyph).rgba[1], 240);
}

}  // namespace
