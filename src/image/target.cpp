// SPDX-License-Identifier: MIT
// The images that a frame is drawn into.
#include "image/target.h"

#include "gpu/commands.h"
#include "gpu/device.h"

namespace isorast {

namespace {

bool is_whole(const gpu::Texture& texture, Size size) {
    return texture && texture.extent().width == size.width &&
           texture.extent().height == size.height;
}

}  // namespace

bool Target::has_sides_of(const Frame& frame) const {
    return size == frame.size && eyes == frame.eyes();
}

bool Target::fits(const Frame& frame) const {
    return has_sides_of(frame) && (frame.isovalues.size() <= 1 || is_whole(surfaces, size)) &&
           (!frame.want_depth || is_whole(distances, size));
}

void Target::fit(const gpu::Device& device, gpu::Commands& commands, const Frame& frame,
                 bool hardware) {
    const bool anew = !has_sides_of(frame);
    size = frame.size;
    eyes = frame.eyes();
    const VkExtent3D whole{size.width, size.height, 1}, one{1, 1, 1};
    const VkImageUsageFlags always = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const VkImageUsageFlags storage =
        always | VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    const VkImageUsageFlags both =
        storage |
        (device.has_graphics() ? VkImageUsageFlags{VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT} : 0u);
    const VkImageUsageFlags attachment = always | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    const auto make = [&](gpu::Texture& texture, VkFormat format, VkExtent3D extent,
                          VkImageUsageFlags usage, const char* what) {
        gpu::ImageInfo info{.format = format,
                            .extent = extent,
                            .usage = usage,
                            .layers = frame.eyes(),
                            .as_bits = format == VK_FORMAT_R32_SFLOAT};
        // Where the CPU draws, images lie in rows anyway: depth can be a buffer's words, too.
        info.linear = &texture == &depth && !hardware && device.is_cpu() &&
                      gpu::Texture::linear_layout(device, info);
        texture = gpu::Texture(device, info, what);
        commands.discard_to_general(texture);
    };
    if (anew) {
        make(color, VK_FORMAT_R8G8B8A8_UNORM, whole, both, "the picture");
        make(depth, hardware ? VK_FORMAT_D32_SFLOAT : VK_FORMAT_R32_SFLOAT, whole,
             hardware ? attachment : storage, "the picture's depth");
    }
    const bool numbered = frame.isovalues.size() > 1;
    if (anew || (numbered && !is_whole(surfaces, size)))
        make(surfaces, VK_FORMAT_R32_UINT, numbered ? whole : one, both,
             "the picture's surface numbers");
    if (anew || (frame.want_depth && !is_whole(distances, size)))
        make(distances, VK_FORMAT_R32_SFLOAT, frame.want_depth ? whole : one, storage,
             "the picture's distances");
}

}  // namespace isorast
