// SPDX-License-Identifier: MIT
// Blocks to triangles by task and mesh shaders, rasterized by the device (Kreskowski 2022, section
// 3.4).
#include <fmt/format.h>
#include <isorast/error.h>

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
    const gpu::Buffer& cases_;
    gpu::Pipeline extract_, extract_numbered_, extract_forward_;
};

Hardware::Hardware(const Grid& grid, const gpu::Buffer& cases) : cases_(cases) {
    const gpu::Device& device = grid.device();
    if (!device.info().why_not_hardware.empty() || !device.features().mesh_shaders)
        throw Error(fmt::format(
            "direct: {} cannot run its hardware rasterizer: {}; use --rasterizer compute",
            device.info().name,
            device.info().why_not_hardware.empty() ? "mesh shaders are not enabled"
                                                   : device.info().why_not_hardware));
    const auto info =
        grid.pipeline_info("extract and rasterize", {Kind::buffer, Kind::buffer}, sizeof(Push));
    const gpu::Shader task{VK_SHADER_STAGE_TASK_BIT_EXT,
                           grid.pick(extract_task, extract_task_bricked)};
    const gpu::Shader mesh{VK_SHADER_STAGE_MESH_BIT_EXT,
                           grid.pick(extract_mesh, extract_mesh_bricked)};
    const gpu::Shader forward_mesh{VK_SHADER_STAGE_MESH_BIT_EXT,
                                   grid.pick(extract_forward_mesh, extract_forward_mesh_bricked)};
    const gpu::Shader numbers{VK_SHADER_STAGE_FRAGMENT_BIT, surface_number_frag};
    const VkFormat depth = VK_FORMAT_D32_SFLOAT;
    extract_ = gpu::Pipeline::graphics(device, info, {task, mesh}, {{}, depth});
    extract_numbered_ =
        gpu::Pipeline::graphics(device, info, {task, mesh, numbers}, {{VK_FORMAT_R32_UINT}, depth});
    extract_forward_ = gpu::Pipeline::graphics(
        device, info, {task, forward_mesh, {VK_SHADER_STAGE_FRAGMENT_BIT, forward_frag}},
        {{VK_FORMAT_R8G8B8A8_UNORM}, depth});
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
    const bool forward = frame.shading == Shading::forward, numbered = frame.isovalues.size() > 1;
    commands.begin_rendering(color_targets(frame, target), &target.depth, /* clear= */ false);
    commands.bind(forward    ? extract_forward_
                  : numbered ? extract_numbered_
                             : extract_,
                  {culling.drawn_blocks(), cases_});
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
