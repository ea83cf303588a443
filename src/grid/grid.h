// SPDX-License-Identifier: MIT
// Grid: a volume resident on the GPU as 3D textures (bricks), and the min-max of its blocks with a
// pyramid up to the root (Kreskowski 2022, section 3.3), for each time step that is there. It also
// owns descriptor set 0, through which every pass sees one of the steps.
#pragma once
#include <isorast/camera.h>
#include <isorast/series.h>

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "gpu/commands.h"
#include "gpu/pipeline.h"
#include "gpu/resources.h"
#include "grid/steps.h"
#include "shaders/shared.h"

namespace isorast {

// What a volume will take on the device, before anything is allocated.
struct GridPlan {
    BrickPlan bricks;
    uint64_t volume_bytes = 0, minmax_bytes = 0;  // of one time step
};
GridPlan plan_grid(const gpu::Device& device, const Volume& volume, uint32_t max_brick_side);

class Grid {
public:
    // `step_bytes`: the budget of Steps.
    Grid(const gpu::Device& device, const Series& series, uint32_t max_brick_side,
         uint64_t step_bytes);
    ~Grid();
    Grid(const Grid&) = delete;
    Grid& operator=(const Grid&) = delete;

    const gpu::Device& device() const { return device_; }
    const shared::GridInfo& info() const { return info_; }
    const Stored& stored() const { return format_.stored; }
    const BrickPlan& bricks() const { return format_.bricks; }
    const Volume& header() const { return header_; }  // of the first step
    const Steps& steps() const { return *steps_; }
    uint64_t extra_bytes() const;
    // The range of the step that is shown, in data units; NaN when no voxel is finite.
    std::array<double, 2> value_range() const;
    // Corners of the first and last block of each row of blocks along x that these isovalues
    // (stored units) cross, in the step that is shown.
    VoxelPoints crossed_hull(const std::vector<float>& isovalues) const;

    VkDescriptorSetLayout scene_layout() const { return scene_layout_; }
    // Pipelines start from this: set 0's layout and the constant that scene.glsl wants, then
    // `more`.
    gpu::PipelineInfo pipeline_info(const char* name, std::vector<gpu::Kind> bindings,
                                    uint32_t push_bytes, std::vector<uint32_t> more = {}) const;
    // Every shader that reads voxels comes in two: for one brick, and for several.
    std::span<const uint32_t> pick(std::span<const uint32_t> one,
                                   std::span<const uint32_t> several) const {
        return format_.bricks.one() ? one : several;
    }
    // False where the texture unit's trilinear filter is too coarse: CPU drivers round its results
    // for 8-bit voxels to 8 bits.
    bool can_filter() const;
    // What the next frames show; see Steps::show.
    void show(uint32_t step, std::vector<uint32_t> in_flight);
    // Makes set 0 and gives it to the commands' passes; `frame` becomes the frame's uniform block.
    // Where a step is shown for the first time, builds its min-max pyramid.
    void begin_frame(gpu::Commands& commands, const shared::FrameInfo& frame);
    // For commands that run at once, while others are still recorded: makes set 0, and the pyramid
    // should only those others build it.
    void begin_alone(gpu::Commands& commands) const;
    // The commands of the last begin_frame() will not run, or have.
    void forget_pyramid() { step_->built = false; }
    void have_run() { step_->may_wait = false; }

private:
    struct Nothing {};
    Grid(const gpu::Device& device, Nothing) : device_(device), sampler_(device) {}
    void make_scene_layout();
    void make_pipelines();
    VkDescriptorSet make_set(gpu::Commands& commands) const;
    void build_step(gpu::Commands& commands) const;
    void sample_formula(gpu::Commands& commands) const;
    void build_minmax(gpu::Commands& commands) const;
    // The stored range of every node of a level of the pyramid, read back.
    std::vector<std::array<float, 2>> read_level(uint32_t level) const;

    const gpu::Device& device_;
    Volume header_;
    StepFormat format_;
    shared::GridInfo info_{};
    std::unique_ptr<Steps> steps_;
    Step* step_ = nullptr;  // the one that is shown
    gpu::Sampler sampler_;
    gpu::Buffer info_buffer_, frame_buffer_;
    VkDescriptorSetLayout scene_layout_ = VK_NULL_HANDLE;
    gpu::Pipeline minmax_blocks_, minmax_level_, sample_field_;
};

}  // namespace isorast
