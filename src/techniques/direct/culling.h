// SPDX-License-Identifier: MIT
// Which blocks to extract: those that the isovalue crosses, in the frustum, and not hidden behind
// others (Kreskowski 2022, section 3.5). All on the GPU; all in compute, for any rasterizer, but
// for the occlusion test by raster proxies.
#pragma once
#include <array>
#include <optional>

#include "gpu/commands.h"
#include "grid/grid.h"
#include "image/target.h"
#include "techniques/direct/occlusion.h"
#include "techniques/direct/workgroups.h"

namespace isorast {

class Culling {
public:
    Culling(const Grid& grid, std::unique_ptr<OcclusionTest> occlusion, Workgroups workgroups);

    // The active groups of each surface: once an isovalue.
    void find_active(gpu::Commands& commands, const std::vector<float>& isovalues);

    // Once a frame, before select(). The blocks marked visible in the last frame become the seen
    // ones, unless the camera is another (a cut). After that, or with another isovalue or time
    // step, in large volumes, rays add what they hit; for the hardware rasterizer also when the
    // camera turns fast. The shading pass marks this frame's visible blocks in
    // target.visible_blocks.
    void begin_frame(gpu::Commands& commands, const Frame& frame, Target& target);
    // Whether this frame leaves out hidden blocks: unless it is not to, or its picture is too large
    // for the occlusion test.
    bool culls() const { return culls_; }
    enum class Select : uint32_t { all, seen, likely, unseen };
    // After such a change, and when the camera moves, seen blocks leave holes, and through a hole
    // all that is behind would be drawn. So likely blocks are drawn before: those that surfaces
    // around the holes do not hide. True if this frame does so.
    bool has_likely() const { return has_likely_; }
    // Before select(likely), with `surfaces`, and before select(unseen): looks at the depth drawn
    // so far. test(): before select(unseen), of each surface.
    void look(gpu::Commands& commands, const Target& target, bool surfaces = false) {
        occlusion_->look(commands, target, surfaces);
    }
    void test(gpu::Commands& commands, uint32_t surface, const Target& target) {
        occlusion_->test(commands, active_groups_[surface], drawn(), target);
    }
    // Lists a surface's blocks: those that are small in the picture, and those that are large. Done
    // at the next barrier.
    enum class Size : uint32_t { small, large };
    void select(gpu::Commands& commands, uint32_t surface, Select which);
    Occlusion occlusion() const { return occlusion_->kind(); }

    // What the last select() has listed: quartets of blocks (drawn.glsl), and draw_count() indirect
    // dispatches or mesh draws for each size, one after the other from first_draw() on in draws().
    const gpu::Buffer& drawn_blocks() const { return drawn_blocks_; }
    const gpu::Buffer& draws() const { return draws_; }
    uint32_t draw_count() const { return draw_count_; }
    uint32_t first_entry(uint32_t draw) const {  // of the list, that this draw draws
        return draw == 0 ? 0 : workgroups_.spread + (draw - 1) * shared::DRAW_QUARTETS;
    }
    uint32_t first_draw(Size size) const { return first_draw_ + uint32_t(size) * draw_count_; }
    // The depth pyramid, if the last select() tested blocks by it: what it hides of a block's cells
    // need not be drawn.
    const gpu::Buffer* pyramid() const { return pyramid_; }
    const gpu::Buffer& counters() const { return counters_; }
    uint64_t gpu_bytes() const;

private:
    void find_active(gpu::Commands& commands, uint32_t surface, float isovalue);
    void guess_visible(gpu::Commands& commands, const Frame& frame) const;
    // What cull.comp goes by; the first three are its SELECT.
    enum class Test : uint32_t { none, seen, tested, hiz, surfaces };
    const gpu::Pipeline& selection(Test test);
    bool hardware() const { return sizes_ == 1; }  // the rasterizer
    // The blocks drawn before select(unseen), of active groups.
    const gpu::Buffer& drawn() const { return has_likely_ ? drawn_before_ : visible_[seen_]; }

    const Grid& grid_;
    Workgroups workgroups_;
    uint32_t sizes_, draw_count_ = 0, first_draw_ = 0;
    uint32_t sifted_ = 0;  // groups that a workgroup of a cull pass looks at first
    uint32_t eyes_ = 1;    // of this frame
    std::unique_ptr<OcclusionTest> occlusion_;
    gpu::Pipeline find_active_, guess_visible_;
    std::array<std::array<gpu::Pipeline, 5>, 2> selections_;  // of eyes, Test; when first needed
    std::vector<gpu::Buffer> active_groups_;                  // one for each surface
    gpu::Buffer drawn_blocks_, draws_, counters_;
    std::array<gpu::Buffer, 2> visible_;  // a bit a block: last frame's and this frame's, in turn
    uint32_t seen_ = 0;                   // which of the two is last frame's
    gpu::Buffer drawn_before_;            // the seen blocks and the likely ones
    const gpu::Buffer* pyramid_ = nullptr;
    bool culls_ = false;    // this frame
    bool changed_ = false;  // the surface, since the last frame
    bool has_likely_ = false;
    bool dear_ = false;                  // blocks, compared with a look at the depth
    bool rays_pay_ = false;              // after other changes than cuts too
    std::optional<Camera> last_camera_;  // of the frame that marked visible blocks
};

}  // namespace isorast
