// SPDX-License-Identifier: MIT
// The shading pass.
#include "image/shade.h"

#include "gpu/device.h"
#include "shade_comp.h"

namespace isorast {

Shade::Shade(const Grid& grid, bool exact)
    : grid_(grid),
      cleared_(grid.device().is_cpu()),
      filtered_(!exact && grid.can_filter() && grid.stored().bits == 8),
      no_blocks_(grid.device(), 4, gpu::Buffer::Memory::device, "shading") {}

const gpu::Pipeline& Shade::pipeline(bool color, bool distance, bool mark) {
    gpu::Pipeline& pipeline = pipelines_[color + 2 * distance + 4 * mark];
    if (!pipeline) {
        using gpu::Kind;
        const std::vector bindings{Kind::texture, Kind::texture, Kind::image, Kind::image,
                                   Kind::buffer};
        pipeline = gpu::Pipeline::compute(
            grid_.device(),
            grid_.pipeline_info("shade", bindings, 0, {color, distance, mark, filtered_, cleared_}),
            grid_.pick(shade_comp, shade_comp_bricked));
    }
    return pipeline;
}

void Shade::record(gpu::Commands& commands, const Frame& frame, const Target& target) {
    const bool color = frame.shading != Shading::forward, mark = target.visible_blocks;
    if (!color && !frame.want_depth && !mark) return;
    const auto pass = commands.pass("shade");
    if (color && cleared_) {
        const auto& [red, green, blue, alpha] = frame.background;
        commands.clear(target.color, {{red, green, blue, alpha}});
        commands.barrier();
    }
    commands.bind(pipeline(color, frame.want_depth, mark),
                  {target.depth, target.surfaces, target.color, target.distances,
                   mark ? *target.visible_blocks : no_blocks_});
    commands.dispatch((target.size.width + 15) / 16, (target.size.height + 15) / 16, target.eyes);
    commands.barrier();
}

}  // namespace isorast
