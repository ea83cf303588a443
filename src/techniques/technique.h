// SPDX-License-Identifier: MIT
// Technique: from a grid to a surface in a target. A technique is a folder here, and nothing else:
// the folder's name is its name everywhere, and make_NAME() in it is all that the rest of isorast
// sees.
#pragma once
#include <isorast/renderer.h>

#include <functional>
#include <memory>

#include "gpu/commands.h"
#include "grid/grid.h"
#include "image/target.h"

namespace isorast {

struct TechniqueContext {
    const Grid& grid;
    const RendererOptions& options;
};

class Technique {
public:
    virtual ~Technique() = default;

    virtual Rasterizer rasterizer() const = 0;  // hardware or compute, never automatic
    virtual bool can_shade_forward() const { return false; }
    // raster or hiz; automatic: it has no occlusion culling.
    virtual Occlusion occlusion() const { return Occlusion::automatic; }

    // Work that depends on the isovalues (stored units) only. Set 0 is bound; ends with a barrier.
    virtual void prepare(gpu::Commands& commands, const std::vector<float>& isovalues) = 0;
    // One frame: fills the target's depth (and surface numbers where there are several surfaces;
    // its colours too with Shading::forward). Ends with a barrier.
    virtual void record(gpu::Commands& commands, const Frame& frame, Target& target) = 0;

    virtual uint64_t gpu_bytes() const { return 0; }
    virtual const gpu::Buffer* counters() const {
        return nullptr;
    }  // shared::Counters of this frame
};

struct TechniqueEntry {
    std::string name;
    std::function<std::unique_ptr<Technique>(const TechniqueContext&)> make;
};
std::vector<TechniqueEntry> technique_registry();  // generated from the folders, in their order

}  // namespace isorast
