// SPDX-License-Identifier: MIT
// Target: what a frame is drawn into. Techniques write depth; the shading pass turns it into
// colours.
#pragma once
#include <isorast/renderer.h>

#include "gpu/resources.h"

namespace isorast {

namespace gpu {
class Commands;
class Device;
}  // namespace gpu

// Depth is reversed: 1 at the near plane, 0 at the far plane and where there is no surface.
struct Target {
    Size size{0, 0};     // of each eye's picture
    uint32_t eyes = 0;   // layers of the images
    gpu::Texture color;  // R8G8B8A8_UNORM
    gpu::Texture depth;  // D32_SFLOAT for the hardware rasterizer, R32_SFLOAT for compute
    // 1x1 until a frame needs them: the number of the surface in each pixel, R32_UINT
    // (several surfaces), and its distance, R32_SFLOAT (Frame::want_depth).
    gpu::Texture surfaces, distances;
    // Where the shading pass marks the blocks that pixels come from, a bit a block; null: nowhere.
    // Set by techniques that want to know.
    const gpu::Buffer* visible_blocks = nullptr;

    // Makes what is missing, and all anew for another size or number of eyes. Not while a frame
    // that uses the old images is in flight.
    void fit(const gpu::Device& device, gpu::Commands& commands, const Frame& frame, bool hardware);
    bool fits(const Frame& frame) const;
    bool has_sides_of(const Frame& frame) const;  // size and eyes
    uint64_t bytes() const {
        return color.bytes() + depth.bytes() + surfaces.bytes() + distances.bytes();
    }
};

}  // namespace isorast
