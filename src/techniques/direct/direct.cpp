// SPDX-License-Identifier: MIT
// direct: Kreskowski, Rendle and Froehlich, "Efficient Direct Isosurface Rasterization of Scalar
// Volumes", 2022. Blocks that the isovalue crosses are listed once an isovalue (find active). Every
// frame (figure 2), those that the last frame saw are extracted and rasterized at once; then those
// that they do not hide. When the camera jumps, or with another isovalue or time step, what the
// last frame saw says little: then what rays hit is drawn with it. What is drawn then, or while the
// camera moves, has holes: blocks that surfaces around do not hide come next. Nothing is stored.
#include <isorast/error.h>

#include <array>

#include "techniques/direct/culling.h"
#include "techniques/direct/rasterizer.h"
#include "techniques/technique.h"

namespace isorast {

namespace {

using gpu::Commands;

class Direct final : public Technique {
public:
    explicit Direct(const TechniqueContext& context);

    Rasterizer rasterizer() const override { return kind_; }
    bool can_shade_forward() const override { return kind_ == Rasterizer::hardware; }
    Occlusion occlusion() const override { return culling_.occlusion(); }
    void prepare(Commands& commands, const std::vector<float>& isovalues) override {
        culling_.find_active(commands, isovalues);
    }
    void record(Commands& commands, const Frame& frame, Target& target) override;
    uint64_t gpu_bytes() const override { return rasterizer_->gpu_bytes() + culling_.gpu_bytes(); }
    const gpu::Buffer* counters() const override { return &culling_.counters(); }

private:
    void clear(Commands& commands, const Frame& frame, const Target& target);
    // Lists blocks, extracts and rasterizes them: one surface after the other, through the same
    // list. `clears` the target before; which must be all or seen.
    void draw(Commands& commands, const Frame& frame, const Target& target, Culling::Select which,
              bool clears = false);

    Rasterizer kind_;
    std::unique_ptr<BlockRasterizer> rasterizer_;
    Culling culling_;
};

std::unique_ptr<OcclusionTest> make_occlusion_test(const TechniqueContext& context) {
    if (context.options.occlusion == Occlusion::raster &&
        context.options.rasterizer == Rasterizer::compute)
        throw Error("direct: raster proxies need the hardware rasterizer; use --culling hiz");
    return context.options.occlusion == Occlusion::raster ? make_raster_proxies(context.grid)
                                                          : make_depth_pyramid(context.grid);
}

Direct::Direct(const TechniqueContext& context)
    : kind_(context.options.rasterizer),
      rasterizer_(kind_ == Rasterizer::compute ? make_compute_rasterizer(context.grid)
                                               : make_hardware_rasterizer(context.grid)),
      culling_(context.grid, make_occlusion_test(context), rasterizer_->workgroups()) {
    if (context.options.exact) throw Error("direct: has no exact way; use --technique raymarch");
}

void Direct::record(Commands& commands, const Frame& frame, Target& target) {
    culling_.begin_frame(commands, frame, target);
    if (frame.isovalues.empty()) return clear(commands, frame, target);
    if (!culling_.culls())
        return draw(commands, frame, target, Culling::Select::all, /* clears= */ true);
    draw(commands, frame, target, Culling::Select::seen, /* clears= */ true);
    if (culling_.has_likely()) {
        culling_.look(commands, target, /* surfaces= */ true);
        draw(commands, frame, target, Culling::Select::likely);
    }
    culling_.look(commands, target);
    draw(commands, frame, target, Culling::Select::unseen);
}

void Direct::clear(Commands& commands, const Frame& frame, const Target& target) {
    const auto pass = commands.pass("clear");
    rasterizer_->clear(commands, frame, target);
    commands.barrier();
}

void Direct::draw(Commands& commands, const Frame& frame, const Target& target,
                  Culling::Select which, bool clears) {
    // Pass names for all, seen, likely and unseen blocks.
    constexpr std::array CULL{"list blocks", "cull seen", "cull likely", "cull unseen"};
    constexpr std::array EXTRACT{"extract", "extract seen", "extract likely", "extract unseen"};
    constexpr std::array CLEAR_AND_CULL{"clear and list blocks", "clear and cull seen"};
    for (uint32_t surface = 0; surface < frame.isovalues.size(); ++surface) {
        if (which == Culling::Select::unseen) culling_.test(commands, surface, target);
        {
            // Side by side: neither keeps a device busy alone.
            const bool both = clears && surface == 0;
            const auto pass =
                commands.pass(both ? CLEAR_AND_CULL[size_t(which)] : CULL[size_t(which)]);
            culling_.select(commands, surface, which);
            if (both) rasterizer_->clear(commands, frame, target);
            commands.barrier();
        }
        const auto pass = commands.pass(EXTRACT[size_t(which)]);
        rasterizer_->extract(commands, culling_, surface, frame, target);
    }
}

}  // namespace

std::unique_ptr<Technique> make_direct(const TechniqueContext& context) {
    return std::make_unique<Direct>(context);
}

}  // namespace isorast
