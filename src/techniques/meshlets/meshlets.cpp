// SPDX-License-Identifier: MIT
// meshlets: the stored mesh that direct is measured against (Kreskowski 2022, section 4, "Optimized
// Mesh Reference"). A new isovalue extracts the whole surface on the GPU, welded, makes meshlets of
// it on the CPU, and stores them; a frame draws those in view that nothing hides.
#include <fmt/format.h>
#include <isorast/error.h>

#include <array>
#include <cstring>

#include "clip_frag.h"
#include "clip_multiview_frag.h"
#include "clip_stereo_frag.h"
#include "draw_meshlets_mesh.h"
#include "draw_meshlets_multiview_mesh.h"
#include "draw_meshlets_stereo_mesh.h"
#include "draw_meshlets_task.h"
#include "gpu/device.h"
#include "passes/depth_pyramid.h"
#include "passes/surface.h"
#include "surface_number_frag.h"
#include "surface_number_multiview_frag.h"
#include "surface_number_stereo_frag.h"
#include "techniques/meshlets/build.h"
#include "techniques/technique.h"

namespace isorast {

namespace {

using gpu::Commands;
using gpu::Kind;
using Memory = gpu::Buffer::Memory;

constexpr uint64_t STAGING_BYTES = 32u << 20;

// Meshlets on the GPU; a surface is as many chunks as the largest storage buffer asks for.
struct Chunk {
    uint32_t surface = 0, meshlet_count = 0;
    gpu::Buffer meshlets, vertices, triangles;
    gpu::Buffer seen;  // by the last frame: a bit a meshlet
    gpu::Buffer draw;  // VkDrawMeshTasksIndirectCommandEXT

    uint64_t bytes() const {
        return meshlets.bytes() + vertices.bytes() + triangles.bytes() + seen.bytes() +
               draw.bytes();
    }
};

struct Push {
    uint32_t meshlet_count, surface, pass, has_seen;
};

class Meshlets final : public Technique {
public:
    explicit Meshlets(const TechniqueContext& context);

    Rasterizer rasterizer() const override { return Rasterizer::hardware; }
    Occlusion occlusion() const override { return Occlusion::hiz; }
    // Submits to the device's queue and waits, so that what frames in flight use is free then.
    void prepare(Commands& commands, const std::vector<float>& isovalues) override;
    void record(Commands& commands, const Frame& frame, Target& target) override;
    uint64_t gpu_bytes() const override;
    const gpu::Buffer* counters() const override { return &counters_; }

private:
    void add_chunk(uint32_t surface, const MeshletMesh& mesh);
    const gpu::Pipeline& pipeline(const Frame& frame);
    void draw(Commands& commands, const Frame& frame, const Target& target, uint32_t pass);
    template <class T>
    gpu::Buffer upload(const std::vector<T>& values) const;

    const Grid& grid_;
    SurfaceExtractor extractor_;
    DepthPyramid pyramid_;
    std::array<gpu::Pipeline, 8> pipelines_;  // made when first needed
    gpu::Buffer counters_;
    std::vector<Chunk> chunks_;
    bool has_seen_ = false;  // a frame has filled Chunk::seen
};

const Grid& checked(const TechniqueContext& context) {
    const gpu::Device& device = context.grid.device();
    if (!device.info().why_not_hardware.empty())
        throw Error(fmt::format("meshlets: {} cannot run it: {}; use --technique direct",
                                device.info().name, device.info().why_not_hardware));
    if (context.options.exact) throw Error("meshlets: has no exact way; use --technique raymarch");
    if (context.options.rasterizer == Rasterizer::compute)
        throw Error(
            "meshlets: has no compute rasterizer; use --rasterizer hardware, or --technique "
            "direct");
    return context.grid;
}

Meshlets::Meshlets(const TechniqueContext& context)
    : grid_(checked(context)),
      extractor_(grid_, /* gradients= */ false),
      pyramid_(grid_),
      counters_(grid_.device(), sizeof(shared::Counters), Memory::device, "counters") {}

const gpu::Pipeline& Meshlets::pipeline(const Frame& frame) {
    const bool numbered = frame.isovalues.size() > 1, clipped = !frame.clips.empty();
    gpu::Pipeline& pipeline = pipelines_[numbered + 2 * (frame.eyes() - 1) + 4 * clipped];
    if (pipeline) return pipeline;

    using Codes = std::array<std::span<const uint32_t>, 3>;
    const Codes mesh{draw_meshlets_mesh, draw_meshlets_stereo_mesh, draw_meshlets_multiview_mesh};
    const Codes clip{clip_frag, clip_stereo_frag, clip_multiview_frag};
    const Codes number{surface_number_frag, surface_number_stereo_frag,
                       surface_number_multiview_frag};
    const auto eyes = size_t(grid_.device().eyes(frame.eyes()));
    std::vector<gpu::Shader> shaders{{VK_SHADER_STAGE_TASK_BIT_EXT, draw_meshlets_task},
                                     {VK_SHADER_STAGE_MESH_BIT_EXT, mesh[eyes]}};
    if (numbered || clipped)
        shaders.push_back({VK_SHADER_STAGE_FRAGMENT_BIT, (numbered ? number : clip)[eyes]});
    std::vector<VkFormat> colors;
    if (numbered) colors = {VK_FORMAT_R32_UINT};
    const auto info =
        grid_.pipeline_info("draw meshlets", std::vector(6, Kind::buffer), sizeof(Push), {clipped});
    pipeline = gpu::Pipeline::graphics(
        grid_.device(), info, shaders,
        {.colors = colors, .depth = VK_FORMAT_D32_SFLOAT, .layers = frame.eyes()});
    return pipeline;
}

uint64_t Meshlets::gpu_bytes() const {
    uint64_t bytes = extractor_.gpu_bytes() + counters_.bytes();
    for (const Chunk& chunk : chunks_)
        bytes += chunk.bytes();
    return bytes;
}

void Meshlets::prepare(Commands& commands, const std::vector<float>& isovalues) {
    const gpu::Device& device = grid_.device();
    gpu::run_once(device, [](Commands&) {});  // frames that use the old chunks have finished
    chunks_.clear();
    has_seen_ = false;
    const uint64_t most =
        std::min<uint64_t>(device.limits().maxStorageBufferRange, device.max_allocation());
    uint64_t needed = grid_.steps().volume_bytes() + grid_.extra_bytes();
    for (uint32_t surface = 0; surface < isovalues.size(); ++surface) {
        const auto meshes =
            build_meshlets(extractor_.extract(isovalues[surface]), grid_.info().blocks, most);
        for (const MeshletMesh& mesh : meshes)
            needed += mesh.bytes();
        if (needed > device.info().memory_bytes)
            throw Error(fmt::format(
                "meshlets: needs {} bytes for the volume and the mesh, {} has {}; use --technique "
                "direct, which stores no mesh",
                needed, device.info().name, device.info().memory_bytes));
        for (const MeshletMesh& mesh : meshes)
            add_chunk(surface, mesh);
    }
    commands.barrier();
}

void Meshlets::add_chunk(uint32_t surface, const MeshletMesh& mesh) {
    const auto count = uint32_t(mesh.meshlets.size());
    const uint32_t groups = (count + shared::TASK_MESHLETS - 1) / shared::TASK_MESHLETS;
    chunks_.push_back({surface, count, upload(mesh.meshlets), upload(mesh.vertices),
                       upload(mesh.triangles), upload(std::vector<uint32_t>(groups)),
                       upload(std::vector<VkDrawMeshTasksIndirectCommandEXT>{{groups, 1, 1}})});
}

template <class T>
gpu::Buffer Meshlets::upload(const std::vector<T>& values) const {
    const gpu::Device& device = grid_.device();
    const uint64_t bytes = values.size() * sizeof(T);
    gpu::Buffer buffer(device, bytes, Memory::device, "meshlets");
    const gpu::Buffer staging(device, std::min(bytes, STAGING_BYTES), Memory::host, "meshlets");
    for (uint64_t done = 0; done < bytes; done += staging.bytes()) {
        const uint64_t piece = std::min(staging.bytes(), bytes - done);
        std::memcpy(staging.data<std::byte>(),
                    reinterpret_cast<const std::byte*>(values.data()) + done, piece);
        gpu::run_once(device,
                      [&](Commands& commands) { commands.copy(staging, 0, buffer, done, piece); });
    }
    return buffer;
}

void Meshlets::record(Commands& commands, const Frame& frame, Target& target) {
    shared::Counters counters{};
    for (const Chunk& chunk : chunks_)
        counters.blocks_active += chunk.meshlet_count;
    commands.update(counters_, 0, &counters, sizeof(counters));
    const bool culls = frame.culling && pyramid_.fit(target);
    commands.barrier();
    if (!culls) return draw(commands, frame, target, shared::ONLY_PASS);
    draw(commands, frame, target, shared::FIRST_PASS);
    pyramid_.build(commands, target);
    draw(commands, frame, target, shared::SECOND_PASS);
    has_seen_ = true;
}

void Meshlets::draw(Commands& commands, const Frame& frame, const Target& target, uint32_t pass) {
    constexpr std::array NAMES{"draw meshlets", "draw seen", "draw unseen"};
    const auto timed = commands.pass(NAMES[pass]);
    std::vector<const gpu::Texture*> colors;
    if (frame.isovalues.size() > 1) colors = {&target.surfaces};
    commands.begin_rendering(colors, &target.depth, /* clear= */ pass != shared::SECOND_PASS);
    for (const Chunk& chunk : chunks_) {
        commands.bind(pipeline(frame),
                      {chunk.meshlets, chunk.vertices, chunk.triangles, chunk.seen,
                       pass == shared::SECOND_PASS ? pyramid_.buffer() : counters_ /* not read */,
                       counters_});
        commands.push(Push{chunk.meshlet_count, chunk.surface, pass, has_seen_});
        commands.draw_mesh_tasks_indirect(chunk.draw, 0);
    }
    commands.end_rendering();
    commands.barrier();
}

}  // namespace

std::unique_ptr<Technique> make_meshlets(const TechniqueContext& context) {
    return std::make_unique<Meshlets>(context);
}

}  // namespace isorast
