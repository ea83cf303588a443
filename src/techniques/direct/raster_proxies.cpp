// SPDX-License-Identifier: MIT
// The occlusion test by raster proxies, as in the paper (sections 3.5.1 and 3.5.2): a quad for each
// block against the depth so far; fragments that pass mark their block. Where the device has the
// representative fragment test, one such fragment ends a quad.
#include <isorast/error.h>

#include <array>

#include "gpu/device.h"
#include "proxies_frag.h"
#include "proxies_mesh.h"
#include "proxies_multiview_mesh.h"
#include "proxies_stereo_mesh.h"
#include "proxies_task.h"
#include "techniques/direct/occlusion.h"

namespace isorast {

namespace {

using gpu::Kind;

// Where the task workgroups are counted in a list of active groups (active_groups.glsl).
constexpr uint64_t TASKS_OFFSET = 16;

class RasterProxies final : public OcclusionTest {
public:
    explicit RasterProxies(const Grid& grid);

    Occlusion kind() const override { return Occlusion::raster; }
    bool fit(const Target&) override { return true; }
    void look(gpu::Commands&, const Target&, bool) override {}
    void test(gpu::Commands& commands, const gpu::Buffer& active_groups, const gpu::Buffer& seen,
              const Target& target) override;
    const gpu::Buffer& result() const override { return tested_; }
    uint64_t gpu_bytes() const override { return tested_.bytes(); }

private:
    std::array<gpu::Pipeline, 2> draw_;  // for one eye and for two
    gpu::Buffer tested_;                 // a bit a block
};

RasterProxies::RasterProxies(const Grid& grid) {
    const gpu::Device& device = grid.device();
    if (!device.features().mesh_shaders || !device.features().fragment_stores)
        throw Error(
            "direct: raster proxies need mesh shaders and fragmentStoresAndAtomics; use "
            "--culling hiz");
    const auto info =
        grid.pipeline_info("raster proxies", {Kind::buffer, Kind::buffer, Kind::buffer}, 0);
    const gpu::Shader task{VK_SHADER_STAGE_TASK_BIT_EXT, proxies_task};
    const gpu::Shader fragment{VK_SHADER_STAGE_FRAGMENT_BIT, proxies_frag};
    const std::array<std::span<const uint32_t>, 3> meshes{proxies_mesh, proxies_stereo_mesh,
                                                          proxies_multiview_mesh};
    for (const uint32_t eyes : {1u, 2u}) {
        const gpu::Attachments attachments{.depth = VK_FORMAT_D32_SFLOAT,
                                           .writes_depth = false,
                                           .layers = eyes,
                                           .representative = device.features().representative_test};
        const gpu::Shader mesh{VK_SHADER_STAGE_MESH_BIT_EXT, meshes[size_t(device.eyes(eyes))]};
        draw_[eyes - 1] =
            gpu::Pipeline::graphics(device, info, {task, mesh, fragment}, attachments);
    }
    tested_ = gpu::Buffer(device, uint64_t{4} * grid.info().groups.w, gpu::Buffer::Memory::device,
                          "visible blocks");
}

void RasterProxies::test(gpu::Commands& commands, const gpu::Buffer& active_groups,
                         const gpu::Buffer& seen, const Target& target) {
    const auto pass = commands.pass("raster proxies");
    commands.fill(tested_, 0);
    commands.barrier();
    commands.begin_rendering({}, &target.depth, /* clear= */ false);
    commands.bind(draw_[target.eyes - 1], {active_groups, seen, tested_});
    commands.draw_mesh_tasks_indirect(active_groups, TASKS_OFFSET);
    commands.end_rendering();
    commands.barrier();
}

}  // namespace

std::unique_ptr<OcclusionTest> make_raster_proxies(const Grid& grid) {
    return std::make_unique<RasterProxies>(grid);
}

}  // namespace isorast
