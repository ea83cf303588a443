// SPDX-License-Identifier: MIT
// The hardware rasterizer: task and mesh shaders extract the listed blocks' triangles and hand them
// to the graphics pipeline (Kreskowski 2022, section 3.4).
#pragma once
#include <array>

#include "techniques/direct/culling.h"
#include "techniques/technique.h"

namespace isorast {

class HardwareRasterizer {
public:
    // Throws Error where the device cannot.
    explicit HardwareRasterizer(const TechniqueContext& context);

    void clear(gpu::Commands& commands, const Frame& frame, const Target& target) const;
    // The blocks that `culling` has listed.
    void extract(gpu::Commands& commands, const Culling& culling, uint32_t surface,
                 const Frame& frame, const Target& target);
    uint64_t gpu_bytes() const { return cases_.bytes(); }

private:
    const gpu::Pipeline& pipeline(const Frame& frame);

    const Grid& grid_;
    std::array<gpu::Pipeline, 12> pipelines_;  // made when first needed
    gpu::Buffer cases_;                        // marching cubes: 256 x uvec2
};

}  // namespace isorast
