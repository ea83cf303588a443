// SPDX-License-Identifier: MIT
// The hardware rasterizer: task and mesh shaders extract the listed blocks' triangles and hand them
// to the graphics pipeline (Kreskowski 2022, section 3.4).
#include <fmt/format.h>
#include <isorast/error.h>

#include <array>

#include "clip_frag.h"
#include "clip_stereo_frag.h"
#include "extract_forward_mesh.h"
#include "extract_forward_stereo_mesh.h"
#include "extract_mesh.h"
#include "extract_stereo_mesh.h"
#include "extract_subgroups_mesh.h"
#include "extract_subgroups_stereo_mesh.h"
#include "extract_subgroups_task.h"
#include "extract_task.h"
#include "forward_frag.h"
#include "forward_stereo_frag.h"
#include "gpu/device.h"
#include "surface_number_frag.h"
#include "surface_number_stereo_frag.h"
#include "techniques/direct/rasterizer.h"

namespace isorast {

namespace {

using gpu::Commands;
using gpu::Kind;

struct Push {
    uint32_t draw, surface, first_draw;
};

// What a picture is drawn into beside depth.
enum class Colors : uint8_t { none, numbers, shaded };

Colors colors_of(const Frame& frame) {
    if (frame.shading == Shading::forward) return Colors::shaded;
    return frame.isovalues.size() > 1 ? Colors::numbers : Colors::none;
}

std::vector<const gpu::Texture*> color_targets(const Frame& frame, const Target& target) {
    switch (colors_of(frame)) {
        case Colors::shaded:
            return {&target.color};
        case Colors::numbers:
            return {&target.surfaces};
        case Colors::none:
            break;
    }
    return {};
}

std::vector<VkFormat> color_formats(Colors colors) {
    if (colors == Colors::none) return {};
    return {colors == Colors::shaded ? VK_FORMAT_R8G8B8A8_UNORM : VK_FORMAT_R32_UINT};
}

class HardwareRasterizer final : public BlockRasterizer {
public:
    explicit HardwareRasterizer(const Grid& grid);

    void clear(Commands& commands, const Frame& frame, const Target& target) const override;
    void extract(Commands& commands, const Culling& culling, uint32_t surface, const Frame& frame,
                 const Target& target) override;
    uint32_t large_parts() const override { return 0; }
    uint64_t gpu_bytes() const override { return triangle_table_.bytes(); }

private:
    const gpu::Pipeline& pipeline(const Frame& frame);
    std::span<const uint32_t> mesh_code(bool forward, bool stereo) const;

    const Grid& grid_;
    gpu::Buffer triangle_table_;
    std::array<gpu::Pipeline, 12> pipelines_;  // made when first needed
};

HardwareRasterizer::HardwareRasterizer(const Grid& grid)
    : grid_(grid), triangle_table_(upload_triangle_table(grid.device())) {
    const gpu::Device& device = grid_.device();
    if (!device.info().why_not_hardware.empty() || !device.features().mesh_shaders)
        throw Error(fmt::format(
            "direct: {} cannot run its hardware rasterizer: {}; use --rasterizer compute",
            device.info().name,
            device.info().why_not_hardware.empty() ? "mesh shaders are not enabled"
                                                   : device.info().why_not_hardware));
}

std::span<const uint32_t> HardwareRasterizer::mesh_code(bool forward, bool stereo) const {
    const bool sums = grid_.device().info().mesh_subgroup_sums;
    if (forward && stereo)
        return grid_.pick(extract_forward_stereo_mesh, extract_forward_stereo_mesh_bricked);
    if (forward) return grid_.pick(extract_forward_mesh, extract_forward_mesh_bricked);
    if (sums && stereo)
        return grid_.pick(extract_subgroups_stereo_mesh, extract_subgroups_stereo_mesh_bricked);
    if (sums) return grid_.pick(extract_subgroups_mesh, extract_subgroups_mesh_bricked);
    if (stereo) return grid_.pick(extract_stereo_mesh, extract_stereo_mesh_bricked);
    return grid_.pick(extract_mesh, extract_mesh_bricked);
}

const gpu::Pipeline& HardwareRasterizer::pipeline(const Frame& frame) {
    const Colors colors = colors_of(frame);
    const bool stereo = frame.eyes() > 1, clipped = !frame.clips.empty();
    gpu::Pipeline& pipeline = pipelines_[size_t(colors) + 3 * stereo + 6 * clipped];
    if (pipeline) return pipeline;

    using Code = std::span<const uint32_t>;
    const bool sums = grid_.device().info().mesh_subgroup_sums;
    const Code task = sums ? grid_.pick(extract_subgroups_task, extract_subgroups_task_bricked)
                           : grid_.pick(extract_task, extract_task_bricked);
    const std::array<Code, 3> fragment{clip_frag, surface_number_frag, forward_frag};
    const std::array<Code, 3> stereo_fragment{clip_stereo_frag, surface_number_stereo_frag,
                                              forward_stereo_frag};
    std::vector<gpu::Shader> shaders{
        {VK_SHADER_STAGE_TASK_BIT_EXT, task},
        {VK_SHADER_STAGE_MESH_BIT_EXT, mesh_code(colors == Colors::shaded, stereo)}};
    if (colors != Colors::none || clipped)
        shaders.push_back(
            {VK_SHADER_STAGE_FRAGMENT_BIT, (stereo ? stereo_fragment : fragment)[size_t(colors)]});
    const auto info =
        grid_.pipeline_info("extract and rasterize", {Kind::buffer, Kind::buffer, Kind::buffer},
                            sizeof(Push), {clipped});
    pipeline = gpu::Pipeline::graphics(grid_.device(), info, shaders,
                                       {color_formats(colors), VK_FORMAT_D32_SFLOAT});
    return pipeline;
}

void HardwareRasterizer::clear(Commands& commands, const Frame& frame, const Target& target) const {
    const Color& b = frame.background;
    VkClearColorValue color{};
    if (frame.shading == Shading::forward) color = {{b.r, b.g, b.b, b.a}};
    commands.begin_rendering(color_targets(frame, target), &target.depth, /* clear= */ true, color);
    commands.end_rendering();
}

void HardwareRasterizer::extract(Commands& commands, const Culling& culling, uint32_t surface,
                                 const Frame& frame, const Target& target) {
    commands.begin_rendering(color_targets(frame, target), &target.depth, /* clear= */ false);
    commands.bind(pipeline(frame), {culling.draws(), culling.drawn_blocks(), triangle_table_});
    const uint32_t first = culling.first_draw(Culling::Size::small);  // here, all are
    for (uint32_t draw = 0; draw < culling.draw_count(); ++draw) {
        commands.push(Push{draw, surface, first});
        commands.draw_mesh_tasks_indirect(culling.draws(), (first + draw) * sizeof(shared::Draw));
    }
    commands.end_rendering();
    commands.barrier();
}

}  // namespace

std::unique_ptr<BlockRasterizer> make_hardware_rasterizer(const Grid& grid) {
    return std::make_unique<HardwareRasterizer>(grid);
}

}  // namespace isorast
