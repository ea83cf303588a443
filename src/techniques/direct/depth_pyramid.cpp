// SPDX-License-Identifier: MIT
// The occlusion test by a depth pyramid (HiZ): cull.comp itself looks blocks up in it.
#include "passes/depth_pyramid.h"

#include "techniques/direct/occlusion.h"

namespace isorast {

namespace {

class PyramidTest final : public OcclusionTest {
public:
    explicit PyramidTest(const Grid& grid) : pyramid_(grid) {}

    Occlusion kind() const override { return Occlusion::hiz; }
    bool fit(const Target& target) override { return pyramid_.fit(target); }
    void look(gpu::Commands& commands, const Target& target, bool surfaces) override {
        pyramid_.build(commands, target, surfaces);
    }
    void test(gpu::Commands&, const gpu::Buffer&, const gpu::Buffer&, const Target&) override {}
    const gpu::Buffer& result() const override { return pyramid_.buffer(); }
    uint64_t gpu_bytes() const override { return 0; }

private:
    DepthPyramid pyramid_;
};

}  // namespace

std::unique_ptr<OcclusionTest> make_depth_pyramid(const Grid& grid) {
    return std::make_unique<PyramidTest>(grid);
}

}  // namespace isorast
