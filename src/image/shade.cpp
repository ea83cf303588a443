// SPDX-License-Identifier: MIT
// The shading pass.
#include "image/shade.h"

#include "gpu/device.h"
#include "shade_comp.h"

namespace isorast {

Shade::Shade(const Grid& grid) : grid_(grid) {
    using gpu::Kind;
    const auto make = [&](bool color, bool distance) {
        const std::vector bindings{Kind::texture, Kind::texture, Kind::image, Kind::image};
        return gpu::Pipeline::compute(
            grid.device(), grid.pipeline_info("shade", bindings, 0, {color, distance}),
            grid.pick(shade_comp, shade_comp_bricked));
    };
    color_ = make(true, false);
    color_and_distance_ = make(true, true);
    distance_ = make(false, true);
}

void Shade::record(gpu::Commands& commands, const Frame& frame, const Target& target) {
    const bool forward = frame.shading == Shading::forward;
    if (forward && !frame.want_depth) return;
    const VkExtent3D wanted = frame.want_depth ? target.color.extent() : VkExtent3D{1, 1, 1};
    const VkExtent3D found = distances_.extent();
    if (!distances_ ||
        (frame.want_depth && (found.width != wanted.width || found.height != wanted.height))) {
        distances_ = gpu::Texture(grid_.device(),
                                  {.format = VK_FORMAT_R32_SFLOAT,
                                   .extent = wanted,
                                   .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
                                  "the picture's distances");
        commands.discard_to_general(distances_);
    }
    const auto pass = commands.pass("shade");
    commands.bind(forward ? distance_ : frame.want_depth ? color_and_distance_ : color_,
                  {target.depth, target.surfaces, target.color, distances_});
    commands.dispatch((target.size.width + 7) / 8, (target.size.height + 7) / 8);
    commands.barrier();
}

}  // namespace isorast
