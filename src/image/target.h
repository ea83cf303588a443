// SPDX-License-Identifier: MIT
// Target: what a frame is drawn into. Techniques write depth; the shading pass turns it into colours.
#pragma once
#include <isorast/image.h>

#include "gpu/resources.h"

namespace isorast {

namespace gpu {
class Commands;
class Device;
}  // namespace gpu

// Depth is reversed: 1 at the near plane, 0 at the far plane and where there is no surface.
struct Target {
    Size size{0, 0};
    gpu::Texture color;     // R8G8B8A8_UNORM
    gpu::Texture depth;     // D32_SFLOAT for the hardware rasterizer, R32_SFLOAT for compute
    gpu::Texture surfaces;  // R32_UINT: the number of the surface in each pixel; 1x1 for one surface

    // Makes what is missing or has another size. Not while a frame that uses the old images is in flight.
    void fit(const gpu::Device& device, gpu::Commands& commands, Size wanted, bool hardware,
             bool several_surfaces);
    bool fits(Size wanted, bool several_surfaces) const;
    uint64_t bytes() const { return color.bytes() + depth.bytes() + surfaces.bytes(); }
};

}  // namespace isorast
