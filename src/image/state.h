// SPDX-License-Identifier: MIT
// Renderer's inside: the grid, one technique, the target, and the frames in flight.
#pragma once
#include <isorast/embed.h>

#include <memory>
#include <optional>
#include <vector>

#include "gpu/commands.h"
#include "grid/grid.h"
#include "image/shade.h"
#include "image/target.h"
#include "image/view.h"
#include "techniques/technique.h"

namespace isorast {

// The technique that the options name. Throws Error when there is none, or the device cannot.
std::unique_ptr<Technique> make_technique(const TechniqueContext& context);

class Renderer::State {
public:
    State(Gpu& gpu, const Series& series, const RendererOptions& options);
    ~State();

    Image render(const Frame& frame);
    RecordedFrame record_for_host(VkCommandBuffer commands, const Frame& frame, uint32_t slot,
                                  const DepthCopies& copies);
    // Submits frames without reading them back, several in flight; their passes' times, in order.
    std::vector<std::vector<gpu::TimedPass>> run(const std::vector<Frame>& frames);

    const RendererOptions& options() const { return options_; }
    const Grid& grid() const { return grid_; }
    const Technique& technique() const { return *technique_; }
    const FrameStats& stats() const { return stats_; }

private:
    // One frame into these commands; `step` keeps its time step while it may be in flight.
    void record(gpu::Commands& commands, const Frame& frame, std::optional<uint32_t>& step);
    void record_passes(gpu::Commands& commands, const Frame& frame);
    template <class Rest>
    void or_forget(Rest&& rest);
    void copy_depth(gpu::Commands& commands, bool as_image);
    Image read_back(const Frame& frame) const;
    void fit_readback(const Frame& frame);
    void collect_stats(const gpu::Slot& slot);

    const gpu::Device& device_;
    Grid grid_;
    RendererOptions options_;
    Placement placement_;
    std::unique_ptr<Technique> technique_;
    Shade shade_;
    Target target_;
    // What the technique is prepared for.
    std::vector<float> prepared_isovalues_;
    std::optional<uint32_t> prepared_step_;
    std::vector<std::unique_ptr<gpu::Submission>> submissions_;
    std::vector<std::unique_ptr<gpu::Slot>> host_slots_;
    std::vector<std::optional<uint32_t>> steps_in_flight_, host_steps_in_flight_;  // one for each
    gpu::Texture depth_image_;                                                     // DepthCopies
    bool depth_image_lost_ = false;  // by commands that will not run; others may still use it
    gpu::Buffer depth_buffer_;
    gpu::Buffer color_readback_, depth_readback_, counters_readback_;
    FrameStats stats_;
};

}  // namespace isorast
