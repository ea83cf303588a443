// SPDX-License-Identifier: MIT
// Two eyes, and clip planes: each eye's picture is right for every technique, culling changes no
// bit, and what a clip plane cuts off is gone and nothing else.
#include <cstring>

#include "gpu/gpu_fixture.h"

namespace {

using namespace isorast;
using namespace reference;

// The picture of one eye from a frame in layers.
Image layer(const Image& layers, size_t eye) {
    const size_t half = layers.depth.size() / 2;
    const auto rgba = layers.rgba.begin() + ptrdiff_t(4 * half * eye);
    const auto depth = layers.depth.begin() + ptrdiff_t(half * eye);
    return {.size = {layers.size.width, layers.size.height / 2},
            .rgba = {rgba, rgba + ptrdiff_t(4 * half)},
            .depth = {depth, depth + ptrdiff_t(half)}};
}

bool same_bits(const Image& a, const Image& b) {
    return a.rgba == b.rgba && a.depth.size() == b.depth.size() &&
           std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * sizeof(float)) == 0;
}

// Eyes that converge far behind everything see the volume as two cameras do that look along
// parallel lines.
TEST_F(GpuTest, EachEyeSeesWhatACameraThereSees) {
    const Volume volume = sampled("coral:64");
    const double voxel = voxel_side(volume);
    for (Lane& lane : lanes(volume))
        for (bool orthographic : {false, true}) {
            Frame f = frame(orbit(volume, 50, 20, {.orthographic = orthographic}), {0.5});
            f.stereo = {.mode = StereoMode::layers, .separation = 0.2, .convergence = 1e7};
            const Image both = lane.renderer.render(f);
            for (size_t eye : {0, 1}) {
                Frame one = f;
                one.stereo = {};
                const dvec3 forward = vector(f.camera.target) - vector(f.camera.position);
                const dvec3 right = glm::normalize(glm::cross(forward, vector(f.camera.up)));
                const dvec3 way = (eye == 0 ? -0.1 : 0.1) * right;
                for (int i = 0; i < 3; ++i) {
                    one.camera.position[i] += way[i];
                    one.camera.target[i] += way[i];
                }
                const Agreement a = agreement(picture(layer(both, eye)),
                                              picture(lane.renderer.render(one)), 4 * voxel);
                EXPECT_GE(a.overlap, 0.9995) << lane.name << eye;
                EXPECT_LE(a.depth_rms / voxel, 1e-3) << lane.name << eye;
                EXPECT_EQ(a.holes, 0u) << lane.name << eye;
            }
        }
}

TEST_F(GpuTest, CullingHoldsForTwoEyesAndMovingClipPlanes) {
    const Volume volume = sampled("noise:56:octaves=3:type=u8");
    auto all = lanes(volume);
    if (gpu.info().why_not_hardware.empty() && !GRAPHICS_CRASHES) {
        const RendererOptions raster{.technique = "direct", .occlusion = Occlusion::raster};
        all.push_back({"direct, raster proxies", raster, Renderer(gpu, volume, raster)});
    }
    for (Lane& lane : all) {
        Renderer whole(gpu, volume, lane.options);
        for (int i = 0; i < view_count(24); ++i) {
            const double turn = i % 5 == 4 ? 90 : 3;
            Frame f = frame(orbit(volume, turn * i, 20, {.zoom = i % 3 ? 1.0 : 3.0}), {0.5});
            f.size = {160, 120};
            if (i % 2) f.stereo.mode = StereoMode::layers;
            if (i % 4) f.clips = {{.normal = {1, 0.3, 0}, .offset = -0.8 + 0.06 * i}};
            if (i % 8 == 7) f.isovalues = {0.45, 0.6};
            if (i % 6 == 5 && lane.options.rasterizer != Rasterizer::compute &&
                lane.options.technique == "direct")
                f.shading = Shading::forward;
            const Image culled = lane.renderer.render(f);
            f.culling = false;
            EXPECT_TRUE(same_bits(culled, whole.render(f))) << lane.name << ' ' << i;
        }
    }
}

TEST_F(GpuTest, ClipPlanesCutOffWhatTheyShould) {
    const Volume volume = sampled("coral:64");
    const double voxel = voxel_side(volume);
    std::optional<Picture> first;
    for (Lane& lane : lanes(volume)) {
        Frame f = frame(orbit(volume, 30, 20), {0.5});
        const Image whole = lane.renderer.render(f);
        f.clips = {{.normal = {0, 0, 2}, .offset = -20}};  // cuts nothing off
        EXPECT_TRUE(same_bits(lane.renderer.render(f), whole)) << lane.name;
        f.clips = {{.normal = {0, 0, 2}, .offset = 20}};  // cuts all off
        for (float depth : lane.renderer.render(f).depth)
            ASSERT_TRUE(std::isinf(depth)) << lane.name;
        // Towards the eye: what is behind the plane and was visible stays, bit for bit in depth.
        const dvec3 way = glm::normalize(vector(f.camera.target) - vector(f.camera.position));
        const double middle = glm::dot(way, vector(f.camera.target) - vector(f.camera.position));
        f.clips = {
            {.normal = {way.x, way.y, way.z}, .offset = glm::dot(way, vector(f.camera.target))}};
        const Image cut = lane.renderer.render(f);
        uint64_t kept = 0, opened = 0;
        for (size_t i = 0; i < cut.depth.size(); ++i) {
            if (whole.depth[i] > middle + 2 * voxel && std::isfinite(whole.depth[i])) {
                EXPECT_NEAR(cut.depth[i], whole.depth[i], 1e-4) << lane.name;
                ++kept;
            } else if (std::isfinite(cut.depth[i])) {
                EXPECT_GT(cut.depth[i], middle - 2 * voxel) << lane.name;
                opened += whole.depth[i] < middle - 2 * voxel;
            }
        }
        EXPECT_GT(kept, 100u);
        EXPECT_GT(opened, 1000u);
        if (!first) first = picture(cut);
        const Agreement a = agreement(picture(cut), *first, 4 * voxel);
        EXPECT_GE(a.overlap, 0.996) << lane.name;  // half a voxel moves the cut
        EXPECT_LE(a.depth_rms / voxel, 0.1) << lane.name;
        EXPECT_LE(a.normal_degrees, 2) << lane.name;
    }
}

}  // namespace
