// SPDX-License-Identifier: MIT
// The shading pass.
#include "image/shade.h"

#include "gpu/device.h"
#include "shade_comp.h"

namespace isorast {

Shade::Shade(const Grid& grid) {
    using gpu::Kind;
    const auto make = [&](bool color, bool distance) {
        const std::vector bindings{Kind::texture, Kind::texture, Kind::image, Kind::image};
        return gpu::Pipeline::compute(grid.device(),
                                      grid.pipeline_info("shade", bindings, 0, {color, distance}),
                                      grid.pick(shade_comp, shade_comp_bricked));
    };
    color_ = make(true, false);
    color_and_distance_ = make(true, true);
    distance_ = make(false, true);
}

void Shade::record(gpu::Commands& commands, const Frame& frame, const Target& target) {
    const bool forward = frame.shading == Shading::forward;
    if (forward && !frame.want_depth) return;
    const auto pass = commands.pass("shade");
    commands.bind(forward            ? distance_
                  : frame.want_depth ? color_and_distance_
                                     : color_,
                  {target.depth, target.surfaces, target.color, target.distances});
    commands.dispatch((target.size.width + 7) / 8, (target.size.height + 7) / 8);
    commands.barrier();
}

}  // namespace isorast
