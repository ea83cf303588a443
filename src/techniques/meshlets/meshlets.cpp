// SPDX-License-Identifier: MIT
// meshlets: the stored mesh that direct is measured against (Kreskowski 2022, section 4, "Optimized
// Mesh Reference"). A new isovalue extracts the whole surface on the GPU, welded, makes meshlets of
// it on the CPU, and stores them; a frame draws those in the frustum.
#include <fmt/format.h>
#include <isorast/error.h>

#include <array>
#include <cstring>

#include "draw_meshlets_mesh.h"
#include "draw_meshlets_task.h"
#include "gpu/device.h"
#include "meshlet_number_frag.h"
#include "passes/surface.h"
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
    gpu::Buffer draw;  // VkDrawMeshTasksIndirectCommandEXT

    uint64_t bytes() const {
        return meshlets.bytes() + vertices.bytes() + triangles.bytes() + draw.bytes();
    }
};

class Meshlets final : public Technique {
public:
    explicit Meshlets(const TechniqueContext& context);

    Rasterizer rasterizer() const override { return Rasterizer::hardware; }
    // Submits to the device's queue and waits, so that what frames in flight use is free then.
    void prepare(Commands& commands, const std::vector<float>& isovalues) override;
    void record(Commands& commands, const Frame& frame, Target& target) override;
    uint64_t gpu_bytes() const override;

private:
    void add_chunk(uint32_t surface, const MeshletMesh& mesh);
    template <class T>
    gpu::Buffer upload(const std::vector<T>& values) const;

    const Grid& grid_;
    SurfaceExtractor extractor_;
    gpu::Pipeline draw_, draw_numbered_;
    std::vector<Chunk> chunks_;
};

const Grid& checked(const TechniqueContext& context) {
    const gpu::Device& device = context.grid.device();
    if (!device.info().why_not_hardware.empty() || !device.features().mesh_shaders)
        throw Error(fmt::format(
            "meshlets: {} cannot run it: {}; use --technique raymarch", device.info().name,
            device.info().why_not_hardware.empty() ? "mesh shaders are not enabled"
                                                   : device.info().why_not_hardware));
    if (context.options.exact) throw Error("meshlets: has no exact way; use --technique raymarch");
    if (context.options.rasterizer == Rasterizer::compute)
        throw Error(
            "meshlets: has no compute rasterizer; use --rasterizer hardware, or --technique "
            "raymarch");
    return context.grid;
}

Meshlets::Meshlets(const TechniqueContext& context)
    : grid_(checked(context)), extractor_(grid_, /* gradients= */ false) {
    const auto info = grid_.pipeline_info("draw meshlets", std::vector(3, Kind::buffer), 12);
    const gpu::Shader task{VK_SHADER_STAGE_TASK_BIT_EXT, draw_meshlets_task};
    const gpu::Shader mesh{VK_SHADER_STAGE_MESH_BIT_EXT, draw_meshlets_mesh};
    const gpu::Shader numbers{VK_SHADER_STAGE_FRAGMENT_BIT, meshlet_number_frag};
    const VkFormat depth = VK_FORMAT_D32_SFLOAT;
    draw_ = gpu::Pipeline::graphics(grid_.device(), info, {task, mesh}, {{}, depth});
    draw_numbered_ = gpu::Pipeline::graphics(grid_.device(), info, {task, mesh, numbers},
                                             {{VK_FORMAT_R32_UINT}, depth});
}

uint64_t Meshlets::gpu_bytes() const {
    uint64_t bytes = extractor_.gpu_bytes();
    for (const Chunk& chunk : chunks_)
        bytes += chunk.bytes();
    return bytes;
}

void Meshlets::prepare(Commands& commands, const std::vector<float>& isovalues) {
    const gpu::Device& device = grid_.device();
    gpu::run_once(device, [](Commands&) {});  // frames that use the old chunks have finished
    chunks_.clear();
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
    const VkDrawMeshTasksIndirectCommandEXT draw{
        (count + shared::TASK_MESHLETS - 1) / shared::TASK_MESHLETS, 1, 1};
    chunks_.push_back({surface, count, upload(mesh.meshlets), upload(mesh.vertices),
                       upload(mesh.triangles), upload(std::vector{draw})});
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
    struct Push {
        uint32_t meshlet_count, surface, culling;
    };
    const auto pass = commands.pass("draw meshlets");
    const bool numbered = frame.isovalues.size() > 1;
    std::vector<const gpu::Texture*> colors;
    if (numbered) colors = {&target.surfaces};
    commands.begin_rendering(colors, &target.depth, /* clear= */ true);
    for (const Chunk& chunk : chunks_) {
        commands.bind(numbered ? draw_numbered_ : draw_,
                      {chunk.meshlets, chunk.vertices, chunk.triangles});
        commands.push(Push{chunk.meshlet_count, chunk.surface, frame.culling});
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
