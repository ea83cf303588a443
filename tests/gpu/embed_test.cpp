// SPDX-License-Identifier: MIT
// Embedding: a host that owns instance, device, queue and command buffers records our frames into
// them, two in flight, and gets the picture that render() makes.
#include <isorast/embed.h>

#include <cstring>

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
}

}  // namespace
