// SPDX-License-Identifier: MIT
// No hole, ever: along each pixel's ray a closed surface is entered as often as it is left. The
// compute rasterizer, built to count instead of keeping the nearest depth (rasterize.comp,
// COUNTING), adds 1 for each front face and takes 1 for each back face: the sum is 0 at every
// pixel. The surface is a shell of random voxels at and around the isovalue; views go from many
// triangles in a pixel to triangles larger than the picture.
#include <isorast/image.h>

#include <optional>
#include <random>

#include "gpu/gpu_fixture.h"
#include "image/view.h"
#include "rasterize_counting.h"
#include "rasterize_large_counting.h"
#include "rasterize_subgroups_counting.h"
#include "techniques/direct/rasterizer.h"

namespace {

using namespace isorast;
using gpu::Kind;
using Memory = gpu::Buffer::Memory;

constexpr uint32_t SNAPPED = 1;  // as on a GPU

class Counting {
public:
    // `sums`: lists are made by many threads and sums across subgroups, and eight workgroups share
    // a large block, as on GPUs; else few threads and one, as on CPUs.
    Counting(const gpu::Device& device, const Volume& volume, Size size, bool sums)
        : grid_(device, series_of({&volume, 1}), 0, 0),
          culling_(grid_, make_depth_pyramid(grid_), workgroups(sums)),
          placement_{volume.affine, volume.dims},
          bytes_(uint64_t{4} * size.width * size.height),
          table_(upload_triangle_table(device)) {
        counts_ =
            gpu::Texture(device,
                         {.format = VK_FORMAT_R32_UINT,
                          .extent = {size.width, size.height, 1},
                          .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                   VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                         "a test");
        read_ = gpu::Buffer(device, bytes_, Memory::host, "a test");
        const std::vector bindings{Kind::buffer, Kind::buffer, Kind::buffer, Kind::image,
                                   Kind::image,  Kind::buffer, Kind::buffer};
        const std::array<std::span<const uint32_t>, 2> code{
            sums ? std::span<const uint32_t>(rasterize_subgroups_counting)
                 : std::span<const uint32_t>(rasterize_counting),
            rasterize_large_counting};
        for (size_t i = 0; i < code.size(); ++i)
            pipelines_[i] = gpu::Pipeline::compute(
                device,
                grid_.pipeline_info("counting", bindings, 20,
                                    {/* CLIPPED= */ 0, SNAPPED, threads(sums, Culling::Size(i)),
                                     workgroups(sums).for_large, /* EYES= */ 1,
                                     /* CELLS_TESTED= */ 0, workgroups(sums).most}),
                code[i]);
        gpu::run_once(device,
                      [&](gpu::Commands& commands) { commands.discard_to_general(counts_); });
    }

    // Front faces less back faces, of each pixel.
    std::span<const int32_t> count(const Frame& frame) {
        gpu::run_once(grid_.device(), [&](gpu::Commands& commands) {
            Target none;
            grid_.begin_frame(commands, make_frame_info(frame, placement_, grid_.stored()));
            culling_.find_active(commands, {grid_.stored().from_value(frame.isovalues[0])});
            culling_.begin_frame(commands, frame, none);
            commands.clear(counts_, {});
            culling_.select(commands, 0, Culling::Select::all);
            commands.barrier();
            for (const auto size : {Culling::Size::small, Culling::Size::large}) {
                const uint32_t first = culling_.first_draw(size);
                commands.bind(pipelines_[size_t(size)], {culling_.draws(), culling_.drawn_blocks(),
                                                         table_, counts_, counts_, table_, table_});
                for (uint32_t draw = 0; draw < culling_.draw_count(); ++draw) {
                    commands.push(std::array<uint32_t, 5>{culling_.first_entry(draw), 0, first});
                    commands.dispatch_indirect(culling_.draws(),
                                               (first + draw) * sizeof(shared::Draw));
                }
            }
            commands.barrier();
            commands.copy_to_buffer(counts_, read_);
        });
        return {read_.data<int32_t>(), bytes_ / 4};
    }

private:
    // So few that these small volumes need a second draw, and workgroups a second quartet.
    static Workgroups workgroups(bool sums) {
        return sums ? Workgroups{8, 5, 0} : Workgroups{1, ~0u, 3};
    }
    static uint32_t threads(bool sums, Culling::Size size) {
        return !sums ? 8 : size == Culling::Size::large ? 128 : 96;
    }

    Grid grid_;
    Culling culling_;
    Placement placement_;
    uint64_t bytes_;
    gpu::Buffer table_, read_;
    gpu::Texture counts_;
    std::array<gpu::Pipeline, 2> pipelines_;  // for small and for large blocks
};

uint64_t not_zero(std::span<const int32_t> counts) {
    return uint64_t(counts.size() - std::ranges::count(counts, 0));
}

TEST_F(GpuTest, FrontFacesLessBackFacesIsZeroAtEveryPixel) {
    const Size size{96, 72};
    std::mt19937 random(5);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution(low, high)(random);
    };
    const int views = std::getenv("ISORAST_QUICK") ? 20 : 250;
    for (uint32_t side : {6u, 15u, 24u, 40u}) {
        const Volume volume = reference::random_blob(side, side);
        Counting plain(gpu.device(), volume, size, /* sums= */ false);
        std::optional<Counting> summing;
        if (gpu.info().subgroup_sums) summing.emplace(gpu.device(), volume, size, /* sums= */ true);
        for (int i = 0; i < views; ++i) {
            const OrbitOptions options{.roll_degrees = uniform(0, 360),
                                       .zoom = std::exp(uniform(-3, 2.5)),
                                       .orthographic = uniform(0, 1) < 0.5};
            Frame f = frame(orbit(volume, uniform(0, 360), uniform(-89, 89), options), {100});
            f.size = size;
            f.culling = false;
            Counting& counting = summing && i % 2 ? *summing : plain;
            ASSERT_EQ(not_zero(counting.count(f)), 0u) << "side " << side << ", view " << i;
        }
    }
}

TEST_F(GpuTest, AnOpenSurfaceIsSeenToBeOpen) {
    const Size size{96, 72};
    const Volume volume = reference::sampled("gyroid:24");
    Frame f = frame(orbit(volume, 30, 20), {0});
    f.size = size;
    f.culling = false;
    EXPECT_GT(not_zero(Counting(gpu.device(), volume, size, false).count(f)), 500u);
}

}  // namespace
