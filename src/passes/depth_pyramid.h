// SPDX-License-Identifier: MIT
// The depth pyramid (HiZ) of what is drawn so far, which shaders/hidden.glsl tests against.
#pragma once
#include <array>

#include "grid/grid.h"
#include "image/target.h"

namespace isorast {

class DepthPyramid {
public:
    explicit DepthPyramid(const Grid& grid);
    // Once a frame, before it: makes what depends on the picture's size. False if the device has
    // no buffer as large: then there is no pyramid, and nothing to test against.
    bool fit(const Target& target);
    // `surfaces`: of surfaces alone, as if there were no holes in them; hides more than is hidden.
    void build(gpu::Commands& commands, const Target& target, bool surfaces = false);
    const gpu::Buffer& buffer() const { return pyramid_; }

private:
    const Grid& grid_;
    std::array<gpu::Pipeline, 2> build_;  // of all, of surfaces: made when first needed
    gpu::Buffer pyramid_;
};

}  // namespace isorast
