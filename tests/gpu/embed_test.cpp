// SPDX-License-Identifier: MIT
// Embedding: a host that owns instance, device, queue and command buffers records our frames into
// them, two in flight, and gets the picture that render() makes.
#include <isorast/embed.h>

#include <algorithm>
#include <cstring>
#include <span>

#include "gpu/commands.h"
#include "gpu/device.h"
#include "gpu/gpu_fixture.h"

namespace {

using namespace isorast;

// The fixture's own device plays the host: everything goes through its plain Vulkan handles.
HostDevice host_of(const gpu::Device& device) {
    HostDevice host;
    host.physical_device = device.physical();
    host.device = device.handle();
    host.queue = device.queue();
    host.queue_family = device.queue_family();
    host.storage_16bit = true;
    host.nonuniform_textures = device.features().nonuniform_textures;
    host.mesh_shaders = device.features().mesh_shaders;
    host.dynamic_rendering = device.features().dynamic_rendering;
    host.fragment_stores = device.features().fragment_stores;
    return host;
}

void copy_color(VkCommandBuffer commands, const RecordedFrame& frame, Size size,
                const gpu::Buffer& pixels) {
    const VkBufferImageCopy region{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                   .imageExtent = {size.width, size.height, 1}};
    vkCmdCopyImageToBuffer(commands, frame.color, VK_IMAGE_LAYOUT_GENERAL, pixels.handle(), 1,
                           &region);
}

TEST_F(GpuTest, AHostRecordsFramesIntoItsOwnCommands) {
    if (GRAPHICS_CRASHES) GTEST_SKIP();
    Gpu adopted(host_of(gpu.device()));
    const Volume volume = reference::sampled("torus:48:type=u8");
    for (Lane& lane : lanes(volume)) {
        Renderer embedded(adopted, volume, lane.options);
        const Frame f = frame(reference::view(volume, 1), {0.0});
        const Image expected = lane.renderer.render(f);

        const uint64_t bytes = uint64_t{4} * SIZE.width * SIZE.height;
        for (uint32_t slot = 0; slot < 2; ++slot) {
            const gpu::Buffer pixels(gpu.device(), bytes, gpu::Buffer::Memory::host, "a test");
            gpu::Submission submission(gpu.device());
            const VkCommandBuffer commands = submission.begin().handle();
            const RecordedFrame recorded = record(embedded, commands, f, slot);
            copy_color(commands, recorded, SIZE, pixels);
            submission.submit();
            submission.wait();
            EXPECT_EQ(std::memcmp(pixels.data<uint8_t>(), expected.rgba.data(), bytes), 0)
                << lane.name;
        }
        EXPECT_THROW(record(embedded, VK_NULL_HANDLE, f, 2), Error);
    }
}

// In one form for all: a D32 image, and a buffer.
TEST_F(GpuTest, AHostGetsTheDepthAsItWants) {
    if (GRAPHICS_CRASHES) GTEST_SKIP();
    Gpu adopted(host_of(gpu.device()));
    const Volume volume = reference::sampled("torus:48:type=u8");
    for (Lane& lane : lanes(volume)) {
        Renderer embedded(adopted, volume, lane.options);
        Frame f = frame(reference::view(volume, 1), {0.0});
        const uint64_t bytes = uint64_t{4} * SIZE.width * SIZE.height;
        const gpu::Buffer drawn(gpu.device(), bytes, gpu::Buffer::Memory::host, "a test");
        const gpu::Buffer image(gpu.device(), bytes, gpu::Buffer::Memory::host, "a test");
        const gpu::Buffer buffer(gpu.device(), bytes, gpu::Buffer::Memory::host, "a test");
        for (const bool copied : {false, true}) {
            gpu::Submission submission(gpu.device());
            const VkCommandBuffer commands = submission.begin().handle();
            const RecordedFrame recorded =
                record(embedded, commands, f, 0, {.image = copied, .buffer = copied});
            const bool as_depth = recorded.depth_format == VK_FORMAT_D32_SFLOAT;
            EXPECT_TRUE(as_depth || !copied) << lane.name;
            EXPECT_EQ(recorded.depth_buffer != VK_NULL_HANDLE, copied) << lane.name;
            const VkImageAspectFlags aspect =
                as_depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
            const VkBufferImageCopy region{.imageSubresource = {aspect, 0, 0, 1},
                                           .imageExtent = {SIZE.width, SIZE.height, 1}};
            vkCmdCopyImageToBuffer(commands, recorded.depth, VK_IMAGE_LAYOUT_GENERAL,
                                   (copied ? image : drawn).handle(), 1, &region);
            const VkBufferCopy all{0, 0, bytes};
            if (copied) vkCmdCopyBuffer(commands, recorded.depth_buffer, buffer.handle(), 1, &all);
            submission.submit();
            submission.wait();
        }
        const std::span depths(drawn.data<float>(), bytes / 4);
        EXPECT_GT(std::ranges::count_if(depths, [](float depth) { return depth > 0; }), 1000);
        EXPECT_EQ(std::memcmp(image.data<float>(), drawn.data<float>(), bytes), 0) << lane.name;
        EXPECT_EQ(std::memcmp(buffer.data<float>(), drawn.data<float>(), bytes), 0) << lane.name;
    }
}

// Without mesh_multiview a host's eyes are layers; where the device has it, the other's are views.
TEST_F(GpuTest, AHostsEyesAreLayersOrViews) {
    if (GRAPHICS_CRASHES) GTEST_SKIP();
    Gpu adopted(host_of(gpu.device()));
    EXPECT_EQ(adopted.device().view_mask(2), 0u);
    const Volume volume = reference::sampled("noise:56:octaves=3:type=u8");
    Frame clipped = frame(orbit(volume, 50, 20), {0.5});
    clipped.stereo = {.mode = StereoMode::layers, .separation = 0.2, .convergence = 2};
    Frame plain = clipped, numbered = clipped, forward = clipped;
    clipped.clips = {{.normal = {1, 0.3, 0}, .offset = 0.1}};
    numbered.isovalues = {0.45, 0.6};
    forward.shading = Shading::forward;
    std::vector<RendererOptions> all;
    for (const Lane& lane : lanes(volume))
        all.push_back(lane.options);
    if (gpu.device().features().mesh_shaders)
        all.push_back({.technique = "direct", .occlusion = Occlusion::raster});
    for (const RendererOptions& options : all) {
        Renderer host(adopted, volume, options), own(gpu, volume, options);
        const bool can_forward =
            options.technique == "direct" && own.rasterizer() == Rasterizer::hardware;
        for (const Frame& f : {plain, clipped, numbered, forward}) {
            if (f.shading == Shading::forward && !can_forward) continue;
            const Image a = host.render(f), b = own.render(f);
            EXPECT_EQ(a.rgba, b.rgba) << options.technique;
            EXPECT_EQ(a.depth, b.depth) << options.technique;
        }
    }
}

TEST_F(GpuTest, AHostWithoutWhatATechniqueNeedsIsTold) {
    if (GRAPHICS_CRASHES) GTEST_SKIP();
    HostDevice host = host_of(gpu.device());
    host.mesh_shaders = false;
    Gpu adopted(host);
    const Volume volume = reference::sampled("torus:16");
    EXPECT_THROW(
        Renderer(adopted, volume, {.technique = "direct", .rasterizer = Rasterizer::hardware}),
        Error);
    EXPECT_EQ(Renderer(adopted, volume).rasterizer(), Rasterizer::compute);
    host.storage_16bit = false;
    EXPECT_THROW(Gpu{host}, Error);
    host = host_of(gpu.device());
    host.queue_family = 1000;
    EXPECT_THROW(Gpu{host}, Error);
    host = host_of(gpu.device());
    host.dynamic_rendering = false;
    Gpu plain(host);
    for (const char* technique : {"direct", "raymarch", "meshlets"})
        EXPECT_THROW(
            Renderer(plain, volume, {.technique = technique, .rasterizer = Rasterizer::hardware}),
            Error)
            << technique;
    EXPECT_EQ(Renderer(plain, volume).rasterizer(), Rasterizer::compute);
}

// Images are made anew for another size or number of eyes, and added when first needed: a host that
// shows both kinds of frames in turn keeps those that it has.
TEST_F(GpuTest, AHostsImagesStay) {
    const Volume volume = reference::sampled("torus:16");
    Gpu adopted(host_of(gpu.device()));
    Renderer renderer(adopted, volume);
    Frame plain = frame(reference::view(volume, 1), {0.0});
    plain.want_depth = false;
    Frame measured = plain, numbered = plain;
    measured.want_depth = true;
    numbered.isovalues = {0.0, 0.1};
    VkImage color = VK_NULL_HANDLE;
    for (const Frame& f : {plain, measured, numbered, plain, measured, numbered}) {
        gpu::Submission submission(gpu.device());
        const RecordedFrame recorded = record(renderer, submission.begin().handle(), f, 0);
        submission.submit();
        submission.wait();
        EXPECT_TRUE(color == VK_NULL_HANDLE || recorded.color == color);
        color = recorded.color;
    }
}

}  // namespace
