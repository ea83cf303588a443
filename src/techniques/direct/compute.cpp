// SPDX-License-Identifier: MIT
// Blocks to triangles to depth in one compute shader: no mesh shaders, no graphics queue. Depth is
// kept by a 32-bit atomic maximum of the float's bits.
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
    Compute(const Grid& grid, const gpu::Buffer& cases) : cases_(cases) {
        const std::vector bindings{Kind::buffer, Kind::buffer, Kind::image, Kind::image};
        const auto info = grid.pipeline_info("rasterize", bindings, sizeof(Push));
        rasterize_ = gpu::Pipeline::compute(grid.device(), info,
                                            grid.pick(rasterize_comp, rasterize_comp_bricked));
        numbered_ = gpu::Pipeline::compute(
            grid.device(), info, grid.pick(rasterize_numbered, rasterize_numbered_bricked));
    }

    void clear(Commands& commands, const Frame&, const Target& target) override {
        commands.clear(target.depth, {});
        commands.barrier();
    }

    void draw(Commands& commands, const Frame& frame, uint32_t surface, const Culling& culling,
              const Target& target) override {
        commands.bind(frame.isovalues.size() > 1 ? numbered_ : rasterize_,
                      {culling.drawn_blocks(), cases_, gpu::Binding(target.depth.bits_view()),
                       target.surfaces});
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
    const gpu::Buffer& cases_;
    gpu::Pipeline rasterize_, numbered_;
};

}  // namespace

std::unique_ptr<DirectRasterizer> make_compute(const Grid& grid, const gpu::Buffer& cases) {
    return std::make_unique<Compute>(grid, cases);
}

}  // namespace isorast
