// SPDX-License-Identifier: MIT
// The compute rasterizer: blocks to triangles to depth in one compute shader; no mesh shaders, no
// graphics queue. Depth is kept by a 32-bit atomic maximum of the float's bits.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "clear_depth_comp.h"
#include "gpu/device.h"
#include "rasterize_comp.h"
#include "rasterize_large.h"
#include "rasterize_large_numbered.h"
#include "rasterize_numbered.h"
#include "rasterize_subgroups.h"
#include "rasterize_subgroups_numbered.h"
#include "techniques/direct/rasterizer.h"

namespace isorast {

namespace {

using gpu::Commands;
using gpu::Kind;
using Size = Culling::Size;

struct Push {
    uint32_t first_entry, surface, first_draw, depth_row, depth_layer;
};

class ComputeRasterizer final : public BlockRasterizer {
public:
    explicit ComputeRasterizer(const Grid& grid)
        : grid_(grid), triangle_table_(upload_triangle_table(grid.device())) {
        if (!grid.device().is_cpu())  // there a command is ten times faster
            clear_ = gpu::Pipeline::compute(grid.device(),
                                            grid.pipeline_info("clear depth", {Kind::image}, 0),
                                            clear_depth_comp);
    }

    void clear(Commands& commands, const Frame&, const Target& target) const override {
        if (!clear_) return commands.clear(target.depth, {});
        commands.bind(clear_, {gpu::Binding(target.depth.bits_view())});
        commands.dispatch((target.size.width + 31) / 32, (target.size.height + 31) / 32,
                          target.eyes);
    }

    void extract(Commands& commands, const Culling& culling, uint32_t surface, const Frame& frame,
                 const Target& target) override {
        const gpu::Texture& depth = target.depth;
        const bool in_buffer = depth.buffer() != VK_NULL_HANDLE;
        for (const Size size : {Size::large, Size::small}) {
            const gpu::Buffer* pyramid = size == Size::small ? culling.pyramid() : nullptr;
            commands.bind(pipeline(frame, size, pyramid != nullptr, in_buffer),
                          {culling.draws(), culling.drawn_blocks(), triangle_table_,
                           gpu::Binding(depth.bits_view()), target.surfaces,
                           pyramid ? *pyramid : triangle_table_ /* not read */,
                           in_buffer ? gpu::Binding(depth.buffer()) : triangle_table_});
            const uint32_t first = culling.first_draw(size);
            for (uint32_t draw = culling.draw_count(); draw-- > 0;) {
                commands.push(Push{culling.first_entry(draw), surface, first,
                                   depth.layout().row_words, depth.layout().slice_words});
                commands.dispatch_indirect(culling.draws(), (first + draw) * sizeof(shared::Draw));
            }
        }
        commands.barrier();
    }

    // Large blocks are few, and have many pixels. A CPU driver shares workgroups out in as many
    // runs as it has threads: blocks from all over the list in each, so that none has more to do.
    Workgroups workgroups() const override {
        return grid_.device().is_cpu() ? Workgroups{1, ~0u, 256} : Workgroups{8, 3072, 0};
    }

    uint64_t gpu_bytes() const override { return triangle_table_.bytes(); }

private:
    const gpu::Pipeline& pipeline(const Frame& frame, Size size, bool cells_tested,
                                  bool in_buffer) {
        const bool numbered = frame.isovalues.size() > 1, clipped = !frame.clips.empty();
        const bool large = size == Size::large;
        const uint32_t eyes = frame.eyes();
        gpu::Pipeline& pipeline = pipelines_[numbered + 2 * clipped + 4 * large + 8 * (eyes - 1) +
                                             16 * cells_tested + 32 * in_buffer];
        if (pipeline) return pipeline;
        const std::vector bindings{Kind::buffer, Kind::buffer, Kind::buffer, Kind::image,
                                   Kind::image,  Kind::buffer, Kind::buffer};
        const bool cpu = grid_.device().is_cpu();
        const uint32_t threads = cpu     ? std::max(8u, grid_.device().info().subgroup_size)
                                 : large ? 128
                                         : 96;
        const Workgroups share = workgroups();
        pipeline = gpu::Pipeline::compute(
            grid_.device(),
            grid_.pipeline_info("rasterize", bindings, sizeof(Push),
                                {clipped, !cpu, threads, share.for_large, eyes, cells_tested,
                                 share.most, grid_.device().in_lockstep(threads), in_buffer}),
            code(numbered, large));
        return pipeline;
    }

    std::span<const uint32_t> code(bool numbered, bool large) const {
        if (large && numbered)
            return grid_.pick(rasterize_large_numbered, rasterize_large_numbered_bricked);
        if (large) return grid_.pick(rasterize_large, rasterize_large_bricked);
        // CPU drivers add up a subgroup lane by lane, and have no atomics that wait for each other.
        const bool sums = grid_.device().info().subgroup_sums && !grid_.device().is_cpu();
        if (sums && numbered)
            return grid_.pick(rasterize_subgroups_numbered, rasterize_subgroups_numbered_bricked);
        if (sums) return grid_.pick(rasterize_subgroups, rasterize_subgroups_bricked);
        if (numbered) return grid_.pick(rasterize_numbered, rasterize_numbered_bricked);
        return grid_.pick(rasterize_comp, rasterize_comp_bricked);
    }

    const Grid& grid_;
    gpu::Buffer triangle_table_;
    gpu::Pipeline clear_;
    std::array<gpu::Pipeline, 64> pipelines_;  // made when first needed
};

}  // namespace

std::unique_ptr<BlockRasterizer> make_compute_rasterizer(const Grid& grid) {
    return std::make_unique<ComputeRasterizer>(grid);
}

}  // namespace isorast
