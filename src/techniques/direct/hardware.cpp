// SPDX-License-Identifier: MIT
// The hardware rasterizer: task and mesh shaders extract the listed blocks' triangles and hand them
// to the graphics pipeline (Kreskowski 2022, section 3.4).
#include <fmt/format.h>
#include <isorast/error.h>

#include <array>

#include "clip_frag.h"
#include "clip_multiview_frag.h"
#include "clip_stereo_frag.h"
#include "extract_forward_mesh.h"
#include "extract_forward_multiview_mesh.h"
#include "extract_forward_stereo_mesh.h"
#include "extract_mesh.h"
#include "extract_multiview_mesh.h"
#include "extract_stereo_mesh.h"
#include "extract_subgroups_mesh.h"
#include "extract_subgroups_multiview_mesh.h"
#include "extract_subgroups_stereo_mesh.h"
#include "extract_subgroups_task.h"
#include "extract_task.h"
#include "forward_frag.h"
#include "forward_multiview_frag.h"
#include "forward_stereo_frag.h"
#include "gpu/device.h"
#include "surface_number_frag.h"
#include "surface_number_multiview_frag.h"
#include "surface_number_stereo_frag.h"
#include "techniques/direct/rasterizer.h"

namespace isorast {

namespace {

using gpu::Commands;
using gpu::Kind;
using Code = std::span<const uint32_t>;

struct Push {
    uint32_t first_entry, surface, first_draw;
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
    Workgroups workgroups() const override { return {0, shared::DRAW_QUARTETS, 0}; }
    uint64_t gpu_bytes() const override { return triangle_table_.bytes(); }

private:
    const gpu::Pipeline& pipeline(const Frame& frame);
    Code mesh_code(bool forward, gpu::Eyes eyes) const;

    const Grid& grid_;
    gpu::Buffer triangle_table_;
    std::array<gpu::Pipeline, 12> pipelines_;  // made when first needed
};

HardwareRasterizer::HardwareRasterizer(const Grid& grid)
    : grid_(grid), triangle_table_(upload_triangle_table(grid.device())) {
    const gpu::Device& device = grid_.device();
    if (!device.info().why_not_hardware.empty())
        throw Error(fmt::format(
            "direct: {} cannot run its hardware rasterizer: {}; use --rasterizer compute",
            device.info().name, device.info().why_not_hardware));
}

Code HardwareRasterizer::mesh_code(bool forward, gpu::Eyes eyes) const {
    const auto pick = [&](const std::array<Code, 3>& one, const std::array<Code, 3>& several) {
        return grid_.pick(one[size_t(eyes)], several[size_t(eyes)]);
    };
    if (forward)
        return pick(
            {extract_forward_mesh, extract_forward_stereo_mesh, extract_forward_multiview_mesh},
            {extract_forward_mesh_bricked, extract_forward_stereo_mesh_bricked,
             extract_forward_multiview_mesh_bricked});
    if (grid_.device().info().mesh_subgroup_sums)
        return pick({extract_subgroups_mesh, extract_subgroups_stereo_mesh,
                     extract_subgroups_multiview_mesh},
                    {extract_subgroups_mesh_bricked, extract_subgroups_stereo_mesh_bricked,
                     extract_subgroups_multiview_mesh_bricked});
    return pick(
        {extract_mesh, extract_stereo_mesh, extract_multiview_mesh},
        {extract_mesh_bricked, extract_stereo_mesh_bricked, extract_multiview_mesh_bricked});
}

const gpu::Pipeline& HardwareRasterizer::pipeline(const Frame& frame) {
    const Colors colors = colors_of(frame);
    const bool clipped = !frame.clips.empty();
    const gpu::Eyes eyes = grid_.device().eyes(frame.eyes());
    gpu::Pipeline& pipeline = pipelines_[size_t(colors) + 3 * (frame.eyes() - 1) + 6 * clipped];
    if (pipeline) return pipeline;

    const bool sums = grid_.device().info().mesh_subgroup_sums;
    const Code task = sums ? grid_.pick(extract_subgroups_task, extract_subgroups_task_bricked)
                           : grid_.pick(extract_task, extract_task_bricked);
    const std::array<std::array<Code, 3>, 3> fragments{
        {{clip_frag, clip_stereo_frag, clip_multiview_frag},
         {surface_number_frag, surface_number_stereo_frag, surface_number_multiview_frag},
         {forward_frag, forward_stereo_frag, forward_multiview_frag}}};
    std::vector<gpu::Shader> shaders{
        {VK_SHADER_STAGE_TASK_BIT_EXT, task},
        {VK_SHADER_STAGE_MESH_BIT_EXT, mesh_code(colors == Colors::shaded, eyes)}};
    if (colors != Colors::none || clipped)
        shaders.push_back({VK_SHADER_STAGE_FRAGMENT_BIT, fragments[size_t(colors)][size_t(eyes)]});
    const auto info =
        grid_.pipeline_info("extract and rasterize", {Kind::buffer, Kind::buffer, Kind::buffer},
                            sizeof(Push), {clipped});
    pipeline = gpu::Pipeline::graphics(
        grid_.device(), info, shaders,
        {.colors = color_formats(colors), .depth = VK_FORMAT_D32_SFLOAT, .layers = frame.eyes()});
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
    for (uint32_t draw = culling.draw_count(); draw-- > 0;) {
        commands.push(Push{culling.first_entry(draw), surface, first});
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
