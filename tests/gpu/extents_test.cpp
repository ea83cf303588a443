// SPDX-License-Identifier: MIT
// What occlusion tests go by: the pixels and the nearest depth that a box can touch hold all of its
// corners, whatever the camera, and hardly more where the box is small and far away.
#include <isorast/image.h>

#include <algorithm>
#include <random>

#include "extents_comp.h"
#include "gpu/commands.h"
#include "gpu/gpu_fixture.h"
#include "gpu/pipeline.h"
#include "grid/grid.h"
#include "image/view.h"

namespace {

using namespace isorast;

struct Box {
    glm::vec4 low, high, pixels, nearest;  // as in extents.comp
};
constexpr uint32_t BOXES = 1024;

TEST_F(GpuTest, TheExtentOfABoxHoldsItsCorners) {
    const Volume volume = reference::sampled("sphere:64");
    Grid grid(gpu.device(), series_of({&volume, 1}), 0, 0);
    const gpu::Pipeline pipeline = gpu::Pipeline::compute(
        gpu.device(), grid.pipeline_info("extents", {gpu::Kind::buffer}, 0), extents_comp);
    const gpu::Buffer buffer(gpu.device(), BOXES * sizeof(Box), gpu::Buffer::Memory::host,
                             "a test");
    std::mt19937 random(3);
    const auto uniform = [&](double low, double high) {
        return float(std::uniform_real_distribution(low, high)(random));
    };
    int before_near = 0, tight = 0;
    for (int view = 0; view < 40; ++view) {
        Frame f = frame(orbit(volume, uniform(0, 360), uniform(-89, 89),
                              {.zoom = std::exp(uniform(-2, 4)), .orthographic = view % 4 == 0}),
                        {0});
        const bool inside = view % 4 == 1;
        if (inside)
            for (int i = 0; i < 3; ++i)
                f.camera.position[i] *= 0.2;
        Box* boxes = buffer.data<Box>();
        for (Box* box = boxes; box < boxes + BOXES; ++box) {
            const float side = box - boxes < BOXES / 2 ? 1.0F : 8.0F;  // a cell, a block
            box->low = {uniform(0, 55), uniform(0, 55), uniform(0, 55), 0};
            box->high = box->low + side;
        }
        const auto info = make_frame_info(f, {volume.affine, volume.dims}, grid.stored());
        gpu::run_once(gpu.device(), [&](gpu::Commands& commands) {
            grid.begin_frame(commands, info);
            commands.barrier();
            commands.bind(pipeline, {buffer});
            commands.dispatch(BOXES / 64);
        });
        const glm::dvec2 picture(info.size.x, info.size.y);
        const glm::dmat4 clip_from_voxel(info.eyes[0].clip_from_voxel);
        for (const Box* box = boxes; box < boxes + BOXES; ++box) {
            glm::dvec2 least(1e9), greatest(-1e9);
            double nearest = 0, least_w = 1e9, greatest_w = 0;
            bool whole = true;
            for (int corner = 0; corner < 8; ++corner) {
                const glm::dvec3 at(glm::mix(glm::vec3(box->low), glm::vec3(box->high),
                                             glm::bvec3(corner & 1, corner & 2, corner & 4)));
                const glm::dvec4 clip = clip_from_voxel * glm::dvec4(at, 1);
                whole = whole && clip.w > 0 && clip.z < clip.w;
                const glm::dvec2 pixel = 0.5 * (glm::dvec2(clip) / clip.w + 1.0) * picture;
                least = glm::min(least, pixel);
                greatest = glm::max(greatest, pixel);
                nearest = std::max(nearest, clip.z / clip.w);
                least_w = std::min(least_w, clip.w);
                greatest_w = std::max(greatest_w, clip.w);
            }
            const bool found_whole = box->low.w != 0;
            before_near += !found_whole;
            if (!found_whole) continue;
            const std::string where = fmt::format("view {}, box {}", view, box - boxes);
            ASSERT_TRUE(whole) << where;
            // Within the picture: what lies beyond is not asked, and far beyond floats are coarse.
            const auto within = [&](glm::dvec2 pixel) {
                return glm::clamp(pixel, glm::dvec2(0), picture);
            };
            const glm::dvec2 found_least(box->pixels.x, box->pixels.y);
            const glm::dvec2 found_greatest(box->pixels.z, box->pixels.w);
            ASSERT_EQ(glm::max(within(found_least), within(least)), within(least)) << where;
            ASSERT_EQ(glm::min(within(found_greatest), within(greatest)), within(greatest))
                << where;
            // So near the eye, view depth has few digits, for rasterizers too.
            ASSERT_GE(box->nearest.x, inside ? 0.9999 * nearest : nearest) << where;
            if (least_w < 0.97 * greatest_w) continue;
            ++tight;
            const glm::dvec2 sides = 1.05 * (greatest - least) + 0.1;
            ASSERT_LE(found_greatest.x - found_least.x, sides.x) << where;
            ASSERT_LE(found_greatest.y - found_least.y, sides.y) << where;
        }
    }
    EXPECT_GT(before_near, 100);
    EXPECT_GT(tight, 10000);
}

}  // namespace
