// SPDX-License-Identifier: MIT
// Blocks to triangles by task and mesh shaders, rasterized by the device (Kreskowski 2022, section
// 3.4).
#include <fmt/format.h>
#include <isorast/error.h>

#include <array>

#include "extract_forward_mesh.h"
#include "extract_mesh.h"
#include "extract_task.h"
#include "forward_frag.h"
#include "gpu/device.h"
#include "surface_number_frag.h"
#include "techniques/direct/rasterizer.h"

namespace isorast {

namespace {

using gpu::Commands;
using gpu::Kind;

class Hardware final : public DirectRasterizer {
public:
    Hardware(const Grid& grid, const gpu::Buffer& cases);

    void clear(Commands& commands, const Frame& frame, const Target& target) override;
    void draw(Commands& commands, const Frame& frame, uint32_t surface, const Culling& culling,
              const Target& target) override;

private:
    struct Push {
        uint32_t chunk, surface;
    };
    // Beside depth.
    enum class Draws : uint8_t { depth, numbers, colors };
    const gpu::Pipeline& pipeline(Draws draws);

    const Grid& grid_;
    const gpu::Buffer& cases_;
    std::array<gpu::Pipeline, 3> pipelines_;  // made when first needed
};

Hardware::Hardware(const Grid& grid, const gpu::Buffer& cases) : grid_(grid), cases_(cases) {
    const gpu::Device& device = grid.device();
    if (!device.info().why_not_hardware.empty() || !device.features().mesh_shaders)
        throw Error(fmt::format(
            "direct: {} cannot run its hardware rasterizer: {}; use --rasterizer compute",
            device.info().name,
            device.info().why_not_hardware.empty() ? "mesh shaders are not enabled"
                                                   : device.info().why_not_hardware));
}

const gpu::Pipeline& Hardware::pipeline(Draws draws) {
    gpu::Pipeline& pipeline = pipelines_[size_t(draws)];
    if (pipeline) return pipeline;
    const auto info =
        grid_.pipeline_info("extract and rasterize", {Kind::buffer, Kind::buffer}, sizeof(Push));
    std::vector<gpu::Shader> shaders{
        {VK_SHADER_STAGE_TASK_BIT_EXT, grid_.pick(extract_task, extract_task_bricked)}};
    gpu::Attachments attachments{{}, VK_FORMAT_D32_SFLOAT};
    if (draws == Draws::colors)
        shaders.push_back({VK_SHADER_STAGE_MESH_BIT_EXT,
                           grid_.pick(extract_forward_mesh, extract_forward_mesh_bricked)});
    else
        shaders.push_back(
            {VK_SHADER_STAGE_MESH_BIT_EXT, grid_.pick(extract_mesh, extract_mesh_bricked)});
    if (draws == Draws::colors) {
        shaders.push_back({VK_SHADER_STAGE_FRAGMENT_BIT, forward_frag});
        attachments.colors = {VK_FORMAT_R8G8B8A8_UNORM};
    }
    if (draws == Draws::numbers) {
        shaders.push_back({VK_SHADER_STAGE_FRAGMENT_BIT, surface_number_frag});
        attachments.colors = {VK_FORMAT_R32_UINT};
    }
    pipeline = gpu::Pipeline::graphics(grid_.device(), info, shaders, attachments);
    return pipeline;
}

// What a picture is drawn into beside depth: colours, the surfaces' numbers, or nothing.
std::vector<const gpu::Texture*> color_targets(const Frame& frame, const Target& target) {
    if (frame.shading == Shading::forward) return {&target.color};
    if (frame.isovalues.size() > 1) return {&target.surfaces};
    return {};
}

void Hardware::clear(Commands& commands, const Frame& frame, const Target& target) {
    const Color& b = frame.background;
    VkClearColorValue color{};
    if (frame.shading == Shading::forward) color = {{b.r, b.g, b.b, b.a}};
    commands.begin_rendering(color_targets(frame, target), &target.depth, /* clear= */ true, color);
    commands.end_rendering();
    commands.barrier();
}

void Hardware::draw(Commands& commands, const Frame& frame, uint32_t surface,
                    const Culling& culling, const Target& target) {
    const Draws draws = frame.shading == Shading::forward ? Draws::colors
                        : frame.isovalues.size() > 1      ? Draws::numbers
                                                          : Draws::depth;
    commands.begin_rendering(color_targets(frame, target), &target.depth, /* clear= */ false);
    commands.bind(pipeline(draws), {culling.drawn_blocks(), cases_});
    for (uint32_t chunk = 0; chunk < culling.chunks(); ++chunk) {
        commands.push(Push{chunk, surface});
        commands.draw_mesh_tasks_indirect(culling.draws(),
                                          chunk * sizeof(VkDrawMeshTasksIndirectCommandEXT));
    }
    commands.end_rendering();
    commands.barrier();
}

}  // namespace

std::unique_ptr<DirectRasterizer> make_hardware(const Grid& grid, const gpu::Buffer& cases) {
    return std::make_unique<Hardware>(grid, cases);
}

}  // namespace isorast
