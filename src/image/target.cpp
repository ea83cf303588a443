// SPDX-License-Identifier: MIT
// The images that a frame is drawn into.
#include "image/target.h"

#include "gpu/commands.h"
#include "gpu/device.h"

namespace isorast {

bool Target::fits(Size wanted, bool several_surfaces) const {
    return size == wanted && surfaces && (surfaces.extent().width == wanted.width || !several_surfaces);
}

void Target::fit(const gpu::Device& device, gpu::Commands& commands, Size wanted, bool hardware,
                 bool several_surfaces) {
    if (fits(wanted, several_surfaces)) return;
    const VkExtent3D whole{wanted.width, wanted.height, 1};
    const VkImageUsageFlags always = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const VkImageUsageFlags attachment =
        device.has_graphics() ? VkImageUsageFlags{VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT} : 0u;
    size = wanted;
    color = gpu::Texture(device,
                         {.format = VK_FORMAT_R8G8B8A8_UNORM,
                          .extent = whole,
                          .usage = always | attachment | VK_IMAGE_USAGE_STORAGE_BIT},
                         "the picture");
    depth = gpu::Texture(
        device,
        {.format = hardware ? VK_FORMAT_D32_SFLOAT : VK_FORMAT_R32_SFLOAT,
         .extent = whole,
         .usage = always | VkImageUsageFlags(hardware ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                                      : VK_IMAGE_USAGE_STORAGE_BIT)},
        "the picture's depth");
    surfaces = gpu::Texture(device,
                            {.format = VK_FORMAT_R32_UINT,
                             .extent = several_surfaces ? whole : VkExtent3D{1, 1, 1},
                             .usage = always | attachment | VK_IMAGE_USAGE_STORAGE_BIT},
                            "the picture's surface numbers");
    for (const gpu::Texture* texture : {&color, &depth, &surfaces}) commands.discard_to_general(*texture);
}

}  // namespace isorast
