// SPDX-License-Identifier: MIT
// The depth pyramid, in compute: for any rasterizer.
#include "passes/depth_pyramid.h"

#include "build_pyramid_comp.h"
#include "build_pyramid_surfaces.h"
#include "gpu/device.h"

namespace isorast {

namespace {

using gpu::Kind;

uint64_t pyramid_bytes(Size size, uint32_t eyes) {
    uint64_t squares = 0;
    for (uint32_t level = 1; level <= 5; ++level) {
        const uint32_t side = 1u << level;
        squares += uint64_t{(size.width + side - 1) / side} * ((size.height + side - 1) / side);
    }
    return sizeof(float) * squares * eyes;
}

}  // namespace

DepthPyramid::DepthPyramid(const Grid& grid) : grid_(grid) {}

bool DepthPyramid::fit(const Target& target) {
    const uint64_t bytes = pyramid_bytes(target.size, target.eyes);
    if (bytes > grid_.device().limits().maxStorageBufferRange) return false;
    if (pyramid_.bytes() != bytes)
        pyramid_ =
            gpu::Buffer(grid_.device(), bytes, gpu::Buffer::Memory::device, "the depth pyramid");
    return true;
}

void DepthPyramid::build(gpu::Commands& commands, const Target& target, bool surfaces) {
    gpu::Pipeline& build = build_[surfaces ? 1 : 0];
    const gpu::Device& device = grid_.device();
    const uint32_t threads = device.is_cpu() ? device.info().subgroup_size : 128;
    if (!build)
        build = gpu::Pipeline::compute(
            device,
            grid_.pipeline_info("depth pyramid", {Kind::texture, Kind::buffer}, 0,
                                {threads, device.in_lockstep(threads)}),
            surfaces ? std::span<const uint32_t>(build_pyramid_surfaces) : build_pyramid_comp);
    const auto pass = commands.pass(surfaces ? "surface pyramid" : "depth pyramid");
    commands.bind(build, {target.depth, pyramid_});
    commands.dispatch((target.size.width + 31) / 32, (target.size.height + 31) / 32, target.eyes);
    commands.barrier();
}

}  // namespace isorast
