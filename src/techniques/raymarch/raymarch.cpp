// SPDX-License-Identifier: MIT
// raymarch: min-max-octree ray marching, the reference that direct is measured against (Kreskowski
// 2022, section 4). One ray a pixel, in a compute shader or, as in the paper, in a fragment shader.
#include <fmt/format.h>
#include <isorast/error.h>

#include "gpu/device.h"
#include "march_comp.h"
#include "march_frag.h"
#include "march_numbered_frag.h"
#include "techniques/technique.h"
#include "whole_picture_vert.h"

namespace isorast {

namespace {

using gpu::Kind;

class Raymarch final : public Technique {
public:
    explicit Raymarch(const TechniqueContext& context);

    Rasterizer rasterizer() const override {
        return hardware_ ? Rasterizer::hardware : Rasterizer::compute;
    }
    void prepare(gpu::Commands&, const std::vector<float>&) override {}
    void record(gpu::Commands& commands, const Frame& frame, Target& target) override;

private:
    bool hardware_ = false;
    gpu::Pipeline march_, march_numbered_;
};

Raymarch::Raymarch(const TechniqueContext& context) {
    const gpu::Device& device = context.grid.device();
    hardware_ = context.options.rasterizer == Rasterizer::hardware;
    const std::vector<uint32_t> constants{context.options.exact,
                                          context.grid.can_filter() ? 1u : 0u};
    if (!hardware_) {
        const auto info =
            context.grid.pipeline_info("march", {Kind::image, Kind::image}, 0, constants);
        march_ =
            gpu::Pipeline::compute(device, info, context.grid.pick(march_comp, march_comp_bricked));
        return;
    }
    if (!device.has_graphics() || !device.features().dynamic_rendering)
        throw Error(
            fmt::format("raymarch: {} has no graphics queue with dynamic rendering; use "
                        "--rasterizer compute",
                        device.info().name));
    const auto info = context.grid.pipeline_info("march", {}, sizeof(uint32_t), constants);
    const gpu::Shader vertex{VK_SHADER_STAGE_VERTEX_BIT, whole_picture_vert};
    const VkFormat depth = VK_FORMAT_D32_SFLOAT;
    march_ = gpu::Pipeline::graphics(
        device, info,
        {vertex, {VK_SHADER_STAGE_FRAGMENT_BIT, context.grid.pick(march_frag, march_frag_bricked)}},
        {{}, depth});
    march_numbered_ = gpu::Pipeline::graphics(
        device, info,
        {vertex,
         {VK_SHADER_STAGE_FRAGMENT_BIT,
          context.grid.pick(march_numbered_frag, march_numbered_frag_bricked)}},
        {{VK_FORMAT_R32_UINT}, depth});
}

void Raymarch::record(gpu::Commands& commands, const Frame& frame, Target& target) {
    const auto pass = commands.pass("march");
    if (!hardware_) {
        commands.bind(march_, {target.depth, target.surfaces});
        commands.dispatch((target.size.width + 7) / 8, (target.size.height + 7) / 8, target.eyes);
    } else {
        const bool numbered = frame.isovalues.size() > 1;
        std::vector<const gpu::Texture*> colors;
        if (numbered) colors = {&target.surfaces};
        for (uint32_t eye = 0; eye < target.eyes; ++eye) {
            commands.begin_rendering(colors, &target.depth, /* clear= */ true, {}, eye);
            commands.bind(numbered ? march_numbered_ : march_, {});
            commands.push(eye);
            commands.draw(3);
            commands.end_rendering();
        }
    }
    commands.barrier();
}

}  // namespace

std::unique_ptr<Technique> make_raymarch(const TechniqueContext& context) {
    return std::make_unique<Raymarch>(context);
}

}  // namespace isorast
