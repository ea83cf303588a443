// SPDX-License-Identifier: MIT
// Blocks to triangles to depth in one compute shader: no mesh shaders, no graphics queue. Depth is
// kept by a 32-bit atomic maximum of the float's bits.
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

class Compute final : public DirectRasterizer {
public:
    Compute(const Grid& grid, const gpu::Buffer& cases) : grid_(grid), cases_(cases) {}

    void clear(Commands& commands, const Frame&, const Target& target) override {
        commands.clear(target.depth, {});
        commands.barrier();
    }

    void draw(Commands& commands, const Frame& frame, uint32_t surface, const Culling& culling,
              const Target& target) override {
        commands.bind(pipeline(frame), {culling.drawn_blocks(), cases_,
                                        gpu::Binding(target.depth.bits_view()), target.surfaces});
        for (uint32_t chunk = 0; chunk < culling.chunks(); ++chunk) {
            commands.push(Push{chunk, surface});
            commands.dispatch_indirect(culling.draws(), chunk * sizeof(VkDispatchIndirectCommand));
        }
        commands.barrier();
    }

private:
    struct Push {
        uint32_t chunk, surface;
    };
    // Made when first needed.
    const gpu::Pipeline& pipeline(const Frame& frame) {
        const bool numbered = frame.isovalues.size() > 1, clipped = !frame.clips.empty();
        gpu::Pipeline& pipeline = pipelines_[numbered + 2 * clipped];
        if (!pipeline) {
            const std::vector bindings{Kind::buffer, Kind::buffer, Kind::image, Kind::image};
            pipeline = gpu::Pipeline::compute(
                grid_.device(), grid_.pipeline_info("rasterize", bindings, sizeof(Push), {clipped}),
                numbered ? grid_.pick(rasterize_numbered, rasterize_numbered_bricked)
                         : grid_.pick(rasterize_comp, rasterize_comp_bricked));
        }
        return pipeline;
    }

    const Grid& grid_;
    const gpu::Buffer& cases_;
    std::array<gpu::Pipeline, 4> pipelines_;
};

}  // namespace

std::unique_ptr<DirectRasterizer> make_compute(const Grid& grid, const gpu::Buffer& cases) {
    return std::make_unique<Compute>(grid, cases);
}

}  // namespace isorast
