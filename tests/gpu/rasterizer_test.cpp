// SPDX-License-Identifier: MIT
// direct's compute rasterizer does what the device's own does: the same pixels, the same depth; and
// it is watertight.
#include <isorast/embed.h>

#include <random>

#include "gpu/commands.h"
#include "gpu/device.h"
#include "gpu/gpu_fixture.h"

namespace {

using namespace isorast;

// The depth that the technique wrote: reversed, 0 where nothing is; not what shading refines.
std::vector<float> raw_depth(const Gpu& gpu, Renderer& renderer, const Frame& frame) {
    const gpu::Device& device = gpu.device();
    const uint64_t pixels = uint64_t{frame.size.width} * frame.size.height;
    const gpu::Buffer buffer(device, 4 * pixels, gpu::Buffer::Memory::host, "a test");
    gpu::Submission submission(device);
    const VkCommandBuffer commands = submission.begin().handle();
    const RecordedFrame recorded = record(renderer, commands, frame, 0);
    const VkImageAspectFlags aspect = recorded.depth_format == VK_FORMAT_D32_SFLOAT
                                          ? VK_IMAGE_ASPECT_DEPTH_BIT
                                          : VK_IMAGE_ASPECT_COLOR_BIT;
    const VkBufferImageCopy region{.imageSubresource = {aspect, 0, 0, 1},
                                   .imageExtent = {frame.size.width, frame.size.height, 1}};
    vkCmdCopyImageToBuffer(commands, recorded.depth, VK_IMAGE_LAYOUT_GENERAL, buffer.handle(), 1,
                           &region);
    submission.submit();
    submission.wait();
    return {buffer.data<float>(), buffer.data<float>() + pixels};
}

// From all around; some orthographic, some close, some from within the volume.
Camera random_view(const Volume& volume, std::mt19937& random) {
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution(low, high)(random);
    };
    OrbitOptions options;
    options.orthographic = uniform(0, 1) < 0.25;
    options.zoom = std::exp(uniform(0, 2));
    options.roll_degrees = uniform(0, 360);
    Camera camera = orbit(volume, uniform(0, 360), uniform(-89, 89), options);
    if (!options.orthographic && uniform(0, 1) < 0.3)
        for (int i = 0; i < 3; ++i)
            camera.position[i] += uniform(0.6, 0.95) * (camera.target[i] - camera.position[i]);
    return camera;
}

struct Difference {
    uint64_t covered = 0, coverage = 0, far = 0;
};

Difference difference(const std::vector<float>& a, const std::vector<float>& b) {
    Difference result;
    for (size_t i = 0; i < a.size(); ++i) {
        if ((a[i] > 0) != (b[i] > 0)) ++result.coverage;
        if (a[i] == 0 || b[i] == 0) continue;
        ++result.covered;
        result.far += std::abs(a[i] - b[i]) > 1e-6;
    }
    return result;
}

TEST_F(GpuTest, TheComputeRasterizerDrawsTheHardwaresPixels) {
    if (GRAPHICS_CRASHES || !gpu.info().why_not_hardware.empty()) GTEST_SKIP();
    std::mt19937 random(3);
    for (const std::string name :
         {"noise:64:type=u8", "sphere:64", "gyroid:48x64x40", "coral:96"}) {
        const Volume volume = reference::sampled(name);
        const double level = suggest_isovalue(volume, statistics(volume));
        Renderer hardware(gpu, volume, {.technique = "direct", .rasterizer = Rasterizer::hardware});
        Renderer compute(gpu, volume, {.technique = "direct", .rasterizer = Rasterizer::compute});
        Difference all;
        const int views = reference::view_count(30);
        for (int i = 0; i < views; ++i) {
            Frame f = frame(random_view(volume, random), {level});
            f.size = {640, 360};
            const Difference d =
                difference(raw_depth(gpu, hardware, f), raw_depth(gpu, compute, f));
            all.covered += d.covered;
            all.coverage += d.coverage;
            all.far += d.far;
        }
        EXPECT_LE(all.coverage * 10000, uint64_t(views) * 640 * 360) << name;
        EXPECT_LE(all.far * 1000, all.covered) << name;
    }
}

}  // namespace
