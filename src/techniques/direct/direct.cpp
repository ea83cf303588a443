// SPDX-License-Identifier: MIT
// direct: Kreskowski, Rendle and Froehlich, "Efficient Direct Isosurface Rasterization of Scalar
// Volumes", 2022. Blocks that the isovalue crosses are listed once an isovalue (find active); every
// frame those in the frustum (cull) are extracted by task and mesh shaders and rasterized at once
// (extract and rasterize). Nothing is stored.
#include <fmt/format.h>
#include <isorast/error.h>

#include "cull_comp.h"
#include "extract_forward_mesh.h"
#include "extract_mesh.h"
#include "extract_task.h"
#include "find_active_comp.h"
#include "forward_frag.h"
#include "gpu/device.h"
#include "shaders/marching_cubes.h"
#include "surface_number_frag.h"
#include "techniques/technique.h"

namespace isorast {

namespace {

using gpu::Commands;
using gpu::Kind;
using Memory = gpu::Buffer::Memory;

// Most workgroups along one axis of a dispatch that every device allows.
constexpr uint32_t MAX_ROW = 65535;
constexpr uint32_t ZERO = 0;

struct DrawPush {
    uint32_t chunk, surface;
};

class Direct final : public Technique {
public:
    explicit Direct(const TechniqueContext& context);

    Rasterizer rasterizer() const override { return Rasterizer::hardware; }
    bool can_shade_forward() const override { return true; }
    void prepare(Commands& commands, const std::vector<float>& isovalues) override;
    void record(Commands& commands, const Frame& frame, Target& target) override;
    uint64_t gpu_bytes() const override;
    const gpu::Buffer* counters() const override { return &counters_; }

private:
    void find_active(Commands& commands, uint32_t surface, float isovalue);
    void cull(Commands& commands, uint32_t surface, bool culling);
    void extract_and_rasterize(Commands& commands, uint32_t surface, const Frame& frame,
                               const Target& target);
    uint64_t group_list_bytes() const { return 16 + uint64_t{8} * grid_.info().groups.w; }

    const Grid& grid_;
    uint32_t chunks_ = 0;
    gpu::Pipeline find_active_, cull_, cull_off_;
    gpu::Pipeline extract_, extract_numbered_, extract_forward_;
    gpu::Buffer cases_;                       // marching cubes: 256 x uvec2
    std::vector<gpu::Buffer> active_groups_;  // one for each surface
    gpu::Buffer drawn_blocks_, draws_, empty_draws_;
    gpu::Buffer counters_;
};

Direct::Direct(const TechniqueContext& context) : grid_(context.grid) {
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

    const auto groups = grid_.info().groups.w;
    chunks_ = (groups + shared::CHUNK_GROUPS - 1) / shared::CHUNK_GROUPS;
    const CaseTable table = marching_cubes_table();
    cases_ = gpu::Buffer(device, sizeof(table.packed), Memory::device, "marching cubes");
    // 2 bytes a block, whole groups; the lists of smaller volumes are as short as they are.
    drawn_blocks_ = gpu::Buffer(device, uint64_t{2} * shared::GROUP_BLOCKS * groups, Memory::device,
                                "the list of drawn blocks");
    const uint64_t draw_bytes = chunks_ * sizeof(VkDrawMeshTasksIndirectCommandEXT);
    draws_ = gpu::Buffer(device, draw_bytes, Memory::device, "draw arguments");
    empty_draws_ = gpu::Buffer(device, draw_bytes, Memory::host, "draw arguments");
    for (uint32_t i = 0; i < chunks_; ++i)
        empty_draws_.data<VkDrawMeshTasksIndirectCommandEXT>()[i] = {0, 2, 1};
    counters_ = gpu::Buffer(device, sizeof(shared::Counters), Memory::device, "counters");
    gpu::run_once(device, [&](Commands& commands) {
        commands.update(cases_, 0, table.packed.data(), sizeof(table.packed));
    });

    find_active_ = gpu::Pipeline::compute(
        device, grid_.pipeline_info("find active", {Kind::buffer, Kind::buffer}, 8),
        find_active_comp);
    const std::vector lists{Kind::buffer, Kind::buffer, Kind::buffer, Kind::buffer};
    cull_ = gpu::Pipeline::compute(device, grid_.pipeline_info("cull", lists, 0, {1}), cull_comp);
    cull_off_ =
        gpu::Pipeline::compute(device, grid_.pipeline_info("cull", lists, 0, {0}), cull_comp);

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

uint64_t Direct::gpu_bytes() const {
    uint64_t bytes =
        cases_.bytes() + drawn_blocks_.bytes() + 2 * draws_.bytes() + counters_.bytes();
    for (const auto& list : active_groups_)
        bytes += list.bytes();
    return bytes;
}

void Direct::prepare(Commands& commands, const std::vector<float>& isovalues) {
    const auto pass = commands.pass("find active");
    while (active_groups_.size() < isovalues.size())
        active_groups_.emplace_back(grid_.device(), group_list_bytes(), Memory::device,
                                    "the list of active blocks");
    commands.fill(counters_, 0);
    for (uint32_t i = 0; i < isovalues.size(); ++i) {
        const std::array<uint32_t, 4> empty{0, 1, 1, 0};
        commands.update(active_groups_[i], 0, empty.data(), sizeof(empty));
    }
    commands.barrier();
    for (uint32_t i = 0; i < isovalues.size(); ++i)
        find_active(commands, i, isovalues[i]);
    commands.barrier();
}

void Direct::find_active(Commands& commands, uint32_t surface, float isovalue) {
    struct Push {
        float isovalue;
        uint32_t groups_in_row;
    };
    const uint32_t workgroups = (grid_.info().groups.w + 3) / 4;
    const uint32_t row = std::min(workgroups, MAX_ROW);
    commands.bind(find_active_, {active_groups_[surface], counters_});
    commands.push(Push{isovalue, row});
    commands.dispatch(row, (workgroups + row - 1) / row);
}

void Direct::record(Commands& commands, const Frame& frame, Target& target) {
    // Surfaces follow each other through the same list of drawn blocks.
    commands.update(counters_, offsetof(shared::Counters, blocks_drawn), &ZERO, sizeof(ZERO));
    for (uint32_t surface = 0; surface < std::max<size_t>(frame.isovalues.size(), 1); ++surface) {
        if (surface < frame.isovalues.size()) cull(commands, surface, frame.culling);
        extract_and_rasterize(commands, surface, frame, target);
    }
}

void Direct::cull(Commands& commands, uint32_t surface, bool culling) {
    const auto pass = commands.pass("cull");
    commands.copy(empty_draws_, 0, draws_, 0, draws_.bytes());
    commands.barrier();
    commands.bind(culling ? cull_ : cull_off_,
                  {active_groups_[surface], draws_, drawn_blocks_, counters_});
    commands.dispatch_indirect(active_groups_[surface], 0);
    commands.barrier();
}

void Direct::extract_and_rasterize(Commands& commands, uint32_t surface, const Frame& frame,
                                   const Target& target) {
    const auto pass = commands.pass("extract and rasterize");
    const bool forward = frame.shading == Shading::forward, numbered = frame.isovalues.size() > 1;
    const gpu::Pipeline& pipeline = forward    ? extract_forward_
                                    : numbered ? extract_numbered_
                                               : extract_;
    std::vector<const gpu::Texture*> colors;
    if (forward)
        colors = {&target.color};
    else if (numbered)
        colors = {&target.surfaces};
    VkClearColorValue clear{};
    if (forward)
        clear = {{frame.background.r, frame.background.g, frame.background.b, frame.background.a}};
    commands.begin_rendering(colors, &target.depth, /* clear= */ surface == 0, clear);
    if (surface < frame.isovalues.size()) {
        commands.bind(pipeline, {drawn_blocks_, cases_});
        for (uint32_t chunk = 0; chunk < chunks_; ++chunk) {
            commands.push(DrawPush{chunk, surface});
            commands.draw_mesh_tasks_indirect(draws_,
                                              chunk * sizeof(VkDrawMeshTasksIndirectCommandEXT));
        }
    }
    commands.end_rendering();
    commands.barrier();
}

}  // namespace

std::unique_ptr<Technique> make_direct(const TechniqueContext& context) {
    return std::make_unique<Direct>(context);
}

}  // namespace isorast
