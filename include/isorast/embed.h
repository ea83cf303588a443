// SPDX-License-Identifier: MIT
// For programs that own a Vulkan device: adopt it, and record isorast frames into their command
// buffers.
#pragma once
#include <isorast/renderer.h>
#include <vulkan/vulkan.h>

namespace isorast {

// The host's Vulkan 1.1 (or later) device. A flag says that the host has enabled that feature; what
// is not enabled is not used, and a technique that needs it says so when it is made.
struct HostDevice {
    VkInstance instance = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;  // with compute; with graphics too for the hardware rasterizer
    uint32_t queue_family = 0;
    // Optional: a queue that can copy and that nobody else uses. Time steps that are not on the GPU
    // yet are then uploaded on it, from another thread, while frames are drawn.
    VkQueue upload_queue = VK_NULL_HANDLE;
    uint32_t upload_queue_family = 0;
    bool storage_16bit = false;  // storageBuffer16BitAccess: required
    bool nonuniform_textures =
        false;  // shaderSampledImageArrayNonUniformIndexing: volumes of several bricks
    bool mesh_shaders = false;       // VK_EXT_mesh_shader with taskShader and meshShader
    bool mesh_multiview = false;     // multiview and multiviewMeshShader, of two views
    bool dynamic_rendering = false;  // Vulkan 1.3 dynamicRendering
    bool storage_without_format =
        false;                     // shaderStorageImageWriteWithoutFormat and ...ExtendedFormats
    bool fragment_stores = false;  // fragmentStoresAndAtomics: occlusion tests by raster proxies
    bool representative_test = false;  // VK_NV_representative_fragment_test
};

// Where a recorded frame's picture will be once the command buffer has run. Images stay in GENERAL
// layout, belong to the Renderer, and are overwritten by the next recorded frame. In stereo they
// have two layers, the left eye's first, and the views are arrays.
struct RecordedFrame {
    VkImage color = VK_NULL_HANDLE;  // R8G8B8A8_UNORM, sRGB-encoded, straight alpha
    VkImageView color_view = VK_NULL_HANDLE;
    VkImage depth =
        VK_NULL_HANDLE;  // reversed: 1 at the near plane, 0 at the far plane and where nothing is
    VkImageView depth_view = VK_NULL_HANDLE;
    VkFormat depth_format = VK_FORMAT_UNDEFINED;
    // Only with DepthCopies::buffer: the same depth as floats, row after row, the right eye's
    // behind the left eye's; a storage buffer and a transfer source.
    VkBuffer depth_buffer = VK_NULL_HANDLE;
};

// For hosts that need the depth in one form, whatever rasterizer drew it: the hardware rasterizers
// leave a D32_SFLOAT image, those in compute an R32_SFLOAT image.
struct DepthCopies {
    bool image = false;   // RecordedFrame::depth is D32_SFLOAT always; needs a queue with graphics
    bool buffer = false;  // RecordedFrame::depth_buffer
};

// Records one frame into `commands`, outside a render pass. `slot`, below
// RendererOptions::frames_in_flight, names the transient resources to use: its previous use must
// have finished on the GPU. A frame of another size or number of eyes makes all images anew, and
// the first after that with several isovalues or with want_depth adds one: then all frames recorded
// before must have finished. At most one frame of a Renderer is recorded at a time. Barriers before
// and after the frame are included. Frames must be submitted, all of them, in the order in which
// they were recorded. A time step that is not on the GPU is waited for here; without
// HostDevice::upload_queue it is also read here, and uploaded by submissions to HostDevice::queue.
// So does the technique meshlets with new isovalues or a new time step, and waits: frames recorded
// before must have been submitted then.
//
// Throws Error as Renderer::render() does, for a slot out of range, and for DepthCopies::image
// without graphics. Then the commands must be discarded, not submitted, and the next frame counts
// as one of another size. The Renderer waits for its own submissions only: destroy it when all
// recorded frames have finished.
RecordedFrame record(Renderer& renderer, VkCommandBuffer commands, const Frame& frame,
                     uint32_t slot, const DepthCopies& copies = {});

}  // namespace isorast
