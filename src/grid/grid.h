// SPDX-License-Identifier: MIT
// Grid: a volume resident on the GPU as 3D textures (bricks), and the min-max of its blocks with a
// pyramid up to the root (Kreskowski 2022, section 3.3). It also owns descriptor set 0, which every
// pass sees.
#pragma once
#include <isorast/camera.h>
#include <isorast/volume.h>

#include <array>
#include <span>
#include <vector>

#include "gpu/commands.h"
#include "gpu/pipeline.h"
#include "gpu/resources.h"
#include "grid/bricks.h"
#include "grid/stored.h"
#include "shaders/shared.h"

namespace isorast {

// What a volume will take on the device, before anything is allocated.
struct GridPlan {
    BrickPlan bricks;
    uint64_t volume_bytes = 0, minmax_bytes = 0;
};
GridPlan plan_grid(const gpu::Device& device, const Volume& volume, uint32_t max_brick_side);

class Grid {
public:
    Grid(const gpu::Device& device, const Volume& volume, uint32_t max_brick_side);
    ~Grid();
    Grid(const Grid&) = delete;
    Grid& operator=(const Grid&) = delete;

    const gpu::Device& device() const { return device_; }
    const shared::GridInfo& info() const { return info_; }
    const Stored& stored() const { return stored_; }
    const BrickPlan& bricks() const { return plan_; }
    uint64_t volume_bytes() const;
    uint64_t extra_bytes() const;
    std::array<double, 2> value_range() const;  // data units; NaN when no voxel is finite
    // Corners of the first and last block of each row of blocks along x that these isovalues
    // (stored units) cross.
    VoxelPoints crossed_hull(const std::vector<float>& isovalues) const;

    VkDescriptorSetLayout scene_layout() const { return scene_layout_; }
    // Pipelines start from this: set 0's layout and the constant that scene.glsl wants, then
    // `more`.
    gpu::PipelineInfo pipeline_info(const char* name, std::vector<gpu::Kind> bindings,
                                    uint32_t push_bytes, std::vector<uint32_t> more = {}) const;
    // Every shader that reads voxels comes in two: for one brick, and for several.
    std::span<const uint32_t> pick(std::span<const uint32_t> one,
                                   std::span<const uint32_t> several) const {
        return plan_.one() ? one : several;
    }
    // False where the texture unit's trilinear filter is too coarse: CPU drivers round its results
    // for 8-bit voxels to 8 bits.
    bool can_filter() const;
    // Makes set 0 and gives it to the commands' passes; `frame` becomes the frame's uniform block.
    void begin_frame(gpu::Commands& commands, const shared::FrameInfo& frame) const;
    // Rebuilds the min-max pyramid from the bricks.
    void build_minmax(gpu::Commands& commands) const;

private:
    void make_scene_layout();
    void upload(const Volume& volume);
    void upload_brick(const Volume& volume, uint32_t brick, gpu::Buffer& staging);
    void sample_on_gpu(const Volume& volume);
    void find_range();
    // The stored range of every node of a level of the pyramid, read back.
    std::vector<std::array<float, 2>> read_level(uint32_t level) const;

    const gpu::Device& device_;
    Stored stored_;
    BrickPlan plan_;
    shared::GridInfo info_{};
    StoredRange range_;
    std::vector<gpu::Texture> textures_;
    gpu::Sampler sampler_;
    gpu::Buffer minmax_, info_buffer_, frame_buffer_;
    VkDescriptorSetLayout scene_layout_ = VK_NULL_HANDLE;
    gpu::Pipeline minmax_blocks_, minmax_level_;
};

}  // namespace isorast
