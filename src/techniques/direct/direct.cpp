// SPDX-License-Identifier: MIT
// direct: Kreskowski, Rendle and Froehlich, "Efficient Direct Isosurface Rasterization of Scalar
// Volumes", 2022. Blocks that the isovalue crosses are listed once an isovalue (find active). Every
// frame (figure 2), those that the last frame saw are extracted by task and mesh shaders and
// rasterized at once; then those that they do not hide. Nothing is stored.
#include <fmt/format.h>
#include <isorast/error.h>

#include <array>

#include "extract_forward_mesh.h"
#include "extract_mesh.h"
#include "extract_task.h"
#include "forward_frag.h"
#include "gpu/device.h"
#include "shaders/marching_cubes.h"
#include "surface_number_frag.h"
#include "techniques/direct/culling.h"
#include "techniques/technique.h"

namespace isorast {

namespace {

using gpu::Commands;
using gpu::Kind;
using Memory = gpu::Buffer::Memory;

struct DrawPush {
    uint32_t chunk, surface;
};

class Direct final : public Technique {
public:
    explicit Direct(const TechniqueContext& context);

    Rasterizer rasterizer() const override { return Rasterizer::hardware; }
    bool can_shade_forward() const override { return true; }
    void prepare(Commands& commands, const std::vector<float>& isovalues) override {
        culling_.find_active(commands, isovalues);
    }
    void record(Commands& commands, const Frame& frame, Target& target) override;
    uint64_t gpu_bytes() const override { return cases_.bytes() + culling_.gpu_bytes(); }
    const gpu::Buffer* counters() const override { return &culling_.counters(); }

private:
    void clear(Commands& commands, const Frame& frame, const Target& target);
    // Lists blocks, extracts and rasterizes them: one surface after the other, through the same
    // list.
    void draw(Commands& commands, const Frame& frame, const Target& target, Culling::Select which);
    void extract_and_rasterize(Commands& commands, uint32_t surface, const Frame& frame,
                               const Target& target);

    const Grid& grid_;
    Culling culling_;
    gpu::Pipeline extract_, extract_numbered_, extract_forward_;
    gpu::Buffer cases_;  // marching cubes: 256 x uvec2
};

Direct::Direct(const TechniqueContext& context) : grid_(context.grid), culling_(context.grid) {
    const gpu::Device& device = grid_.device();
    if (!device.info().why_not_hardware.empty() || !device.features().mesh_shaders)
        throw Error(fmt::format(
            "direct: {} cannot run its hardware rasterizer: {}; use --technique raymarch",
            device.info().name,
            device.info().why_not_hardware.empty() ? "mesh shaders are not enabled"
                                                   : device.info().why_not_hardware));
    if (context.options.exact) throw Error("direct: has no exact way; use --technique raymarch");
    if (context.options.rasterizer == Rasterizer::compute)
        throw Error(
            "direct: has no compute rasterizer yet; use --rasterizer hardware, or --technique "
            "raymarch");

    const CaseTable table = marching_cubes_table();
    cases_ = gpu::Buffer(device, sizeof(table.packed), Memory::device, "marching cubes");
    gpu::run_once(device, [&](Commands& commands) {
        commands.update(cases_, 0, table.packed.data(), sizeof(table.packed));
    });

    const auto info = grid_.pipeline_info("extract and rasterize", {Kind::buffer, Kind::buffer},
                                          sizeof(DrawPush));
    const gpu::Shader task{VK_SHADER_STAGE_TASK_BIT_EXT,
                           grid_.pick(extract_task, extract_task_bricked)};
    const gpu::Shader mesh{VK_SHADER_STAGE_MESH_BIT_EXT,
                           grid_.pick(extract_mesh, extract_mesh_bricked)};
    const gpu::Shader forward_mesh{VK_SHADER_STAGE_MESH_BIT_EXT,
                                   grid_.pick(extract_forward_mesh, extract_forward_mesh_bricked)};
    const gpu::Shader numbers{VK_SHADER_STAGE_FRAGMENT_BIT, surface_number_frag};
    const VkFormat depth = VK_FORMAT_D32_SFLOAT;
    extract_ = gpu::Pipeline::graphics(device, info, {task, mesh}, {{}, depth});
    extract_numbered_ =
        gpu::Pipeline::graphics(device, info, {task, mesh, numbers}, {{VK_FORMAT_R32_UINT}, depth});
    extract_forward_ = gpu::Pipeline::graphics(
        device, info, {task, forward_mesh, {VK_SHADER_STAGE_FRAGMENT_BIT, forward_frag}},
        {{VK_FORMAT_R8G8B8A8_UNORM}, depth});
}

void Direct::record(Commands& commands, const Frame& frame, Target& target) {
    culling_.begin_frame(commands, frame, target);
    clear(commands, frame, target);
    if (!frame.culling) return draw(commands, frame, target, Culling::Select::all);
    draw(commands, frame, target, Culling::Select::seen);
    culling_.build_pyramid(commands, target);
    draw(commands, frame, target, Culling::Select::unseen);
}

// What a picture is drawn into beside depth: colours, the surfaces' numbers, or nothing.
std::vector<const gpu::Texture*> color_targets(const Frame& frame, const Target& target) {
    if (frame.shading == Shading::forward) return {&target.color};
    if (frame.isovalues.size() > 1) return {&target.surfaces};
    return {};
}

void Direct::clear(Commands& commands, const Frame& frame, const Target& target) {
    const auto pass = commands.pass("clear");
    const Color& b = frame.background;
    VkClearColorValue color{};
    if (frame.shading == Shading::forward) color = {{b.r, b.g, b.b, b.a}};
    commands.begin_rendering(color_targets(frame, target), &target.depth, /* clear= */ true, color);
    commands.end_rendering();
    commands.barrier();
}

void Direct::draw(Commands& commands, const Frame& frame, const Target& target,
                  Culling::Select which) {
    // Pass names for all, seen and unseen blocks.
    constexpr std::array CULL{"list blocks", "cull seen", "cull unseen"};
    constexpr std::array EXTRACT{"extract", "extract seen", "extract unseen"};
    for (uint32_t surface = 0; surface < frame.isovalues.size(); ++surface) {
        {
            const auto pass = commands.pass(CULL[size_t(which)]);
            culling_.select(commands, surface, which);
        }
        const auto pass = commands.pass(EXTRACT[size_t(which)]);
        extract_and_rasterize(commands, surface, frame, target);
    }
}

void Direct::extract_and_rasterize(Commands& commands, uint32_t surface, const Frame& frame,
                                   const Target& target) {
    const bool forward = frame.shading == Shading::forward, numbered = frame.isovalues.size() > 1;
    commands.begin_rendering(color_targets(frame, target), &target.depth, /* clear= */ false);
    commands.bind(forward    ? extract_forward_
                  : numbered ? extract_numbered_
                             : extract_,
                  {culling_.drawn_blocks(), cases_});
    for (uint32_t chunk = 0; chunk < culling_.chunks(); ++chunk) {
        commands.push(DrawPush{chunk, surface});
        commands.draw_mesh_tasks_indirect(culling_.draws(),
                                          chunk * sizeof(VkDrawMeshTasksIndirectCommandEXT));
    }
    commands.end_rendering();
    commands.barrier();
}

}  // namespace

std::unique_ptr<Technique> make_direct(const TechniqueContext& context) {
    return std::make_unique<Direct>(context);
}

}  // namespace isorast
