// SPDX-License-Identifier: MIT
// The occlusion test by a depth pyramid (HiZ), in compute: for any rasterizer.
#include <cstdint>

#include "build_pyramid_comp.h"
#include "techniques/direct/occlusion.h"

namespace isorast {

namespace {

using gpu::Kind;

uint64_t pyramid_bytes(Size size, uint32_t eyes) {
    uint64_t squares = 0;
    for (uint32_t level = 1; level <= 6; ++level) {
        const uint32_t side = 1u << level;
        squares += uint64_t{(size.width + side - 1) / side} * ((size.height + side - 1) / side);
    }
    return sizeof(float) * squares * eyes;
}

class DepthPyramid final : public OcclusionTest {
public:
    explicit DepthPyramid(const Grid& grid)
        : grid_(grid),
          build_(gpu::Pipeline::compute(
              grid.device(), grid.pipeline_info("depth pyramid", {Kind::texture, Kind::buffer}, 0),
              build_pyramid_comp)) {}

    Occlusion kind() const override { return Occlusion::hiz; }
    void fit(const Target& target) override {
        const uint64_t bytes = pyramid_bytes(target.size, target.eyes);
        if (pyramid_.bytes() != bytes)
            pyramid_ = gpu::Buffer(grid_.device(), bytes, gpu::Buffer::Memory::device,
                                   "the depth pyramid");
    }
    void look(gpu::Commands& commands, const Target& target) override {
        const auto pass = commands.pass("depth pyramid");
        commands.bind(build_, {target.depth, pyramid_});
        commands.dispatch((target.size.width + 63) / 64, (target.size.height + 63) / 64,
                          target.eyes);
        commands.barrier();
    }
    void test(gpu::Commands&, const gpu::Buffer&, const gpu::Buffer&, const Target&) override {}
    const gpu::Buffer& result() const override { return pyramid_; }
    uint64_t gpu_bytes() const override { return 0; }

private:
    const Grid& grid_;
    gpu::Pipeline build_;
    gpu::Buffer pyramid_;
};

}  // namespace

std::unique_ptr<OcclusionTest> make_depth_pyramid(const Grid& grid) {
    return std::make_unique<DepthPyramid>(grid);
}

}  // namespace isorast
