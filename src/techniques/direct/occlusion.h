// SPDX-License-Identifier: MIT
// Occlusion tests: which blocks that the last frame did not see are hidden by those that it saw
// (Kreskowski 2022, section 3.5). Two ways behind one interface; both may call a hidden block
// visible, never a visible one hidden.
#pragma once
#include <memory>

#include "gpu/commands.h"
#include "grid/grid.h"
#include "image/target.h"

namespace isorast {

class OcclusionTest {
public:
    virtual ~OcclusionTest() = default;
    virtual Occlusion kind() const = 0;
    // Once a frame, before it: makes what depends on the picture's size. False if the picture is
    // too large for the test.
    virtual bool fit(const Target& target) = 0;
    // When all blocks that the last frame saw are drawn; of a frame that draws likely blocks before
    // the others (see Culling), HiZ: with `surfaces` before these, and without after them.
    virtual void look(gpu::Commands& commands, const Target& target, bool surfaces) = 0;
    // For one surface: its active groups, and a bit for each block that the last frame saw.
    virtual void test(gpu::Commands& commands, const gpu::Buffer& active_groups,
                      const gpu::Buffer& seen, const Target& target) = 0;
    // What cull.comp then reads: the depth pyramid, or a bit for each visible block.
    virtual const gpu::Buffer& result() const = 0;
    virtual uint64_t gpu_bytes() const = 0;  // what depends on the picture's size aside
};

std::unique_ptr<OcclusionTest> make_depth_pyramid(const Grid& grid);
std::unique_ptr<OcclusionTest> make_raster_proxies(const Grid& grid);

}  // namespace isorast
