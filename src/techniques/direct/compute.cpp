// SPDX-License-Identifier: MIT
// The compute rasterizer: blocks to triangles to depth in one compute shader; no mesh shaders, no
// graphics queue. Depth is kept by a 32-bit atomic maximum of the float's bits.
#include <array>
#include <cstdint>
#include <vector>

#include "rasterize_comp.h"
#include "rasterize_numbered.h"
#include "techniques/direct/rasterizer.h"

namespace isorast {

namespace {

using gpu::Commands;
using gpu::Kind;

struct Push {
    uint32_t draw, surface;
};

class ComputeRasterizer final : public BlockRasterizer {
public:
    ComputeRasterizer(const Grid& grid, const gpu::Buffer& cases) : grid_(grid), cases_(cases) {}

    void clear(Commands& commands, const Frame&, const Target& target) const override {
        commands.clear(target.depth, {});
        commands.barrier();
    }

    void extract(Commands& commands, const Culling& culling, uint32_t surface, const Frame& frame,
                 const Target& target) override {
        commands.bind(pipeline(frame), {culling.drawn_blocks(), cases_,
                                        gpu::Binding(target.depth.bits_view()), target.surfaces});
        for (uint32_t draw = 0; draw < culling.draw_count(); ++draw) {
            commands.push(Push{draw, surface});
            commands.dispatch_indirect(culling.draws(), draw * sizeof(VkDispatchIndirectCommand));
        }
        commands.barrier();
    }

private:
    const gpu::Pipeline& pipeline(const Frame& frame) {
        const bool numbered = frame.isovalues.size() > 1, clipped = !frame.clips.empty();
        gpu::Pipeline& pipeline = pipelines_[size_t(numbered) + 2 * clipped];
        if (pipeline) return pipeline;
        const std::vector bindings{Kind::buffer, Kind::buffer, Kind::image, Kind::image};
        pipeline = gpu::Pipeline::compute(
            grid_.device(), grid_.pipeline_info("rasterize", bindings, sizeof(Push), {clipped}),
            numbered ? grid_.pick(rasterize_numbered, rasterize_numbered_bricked)
                     : grid_.pick(rasterize_comp, rasterize_comp_bricked));
        return pipeline;
    }

    const Grid& grid_;
    const gpu::Buffer& cases_;
    std::array<gpu::Pipeline, 4> pipelines_;  // made when first needed
};

}  // namespace

std::unique_ptr<BlockRasterizer> make_compute_rasterizer(const Grid& grid,
                                                         const gpu::Buffer& cases) {
    return std::make_unique<ComputeRasterizer>(grid, cases);
}

}  // namespace isorast
