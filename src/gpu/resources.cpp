// SPDX-License-Identifier: MIT
// Buffers, images and samplers.
#include "gpu/resources.h"

#include <algorithm>
#include <array>
#include <utility>

#include "gpu/device.h"
#include "gpu/vulkan_check.h"

namespace isorast::gpu {

// Constructors begin with the one that has nothing: should they throw, destructors run.
Buffer::Buffer(const Device& device, uint64_t bytes, Memory memory, const char* what) : Buffer() {
    device_ = &device;
    bytes_ = bytes;
    const VkBufferCreateInfo info{
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = bytes,
        .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                 VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                 VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    VK_CHECK(vkCreateBuffer(device.handle(), &info, nullptr, &buffer_));
    VkMemoryRequirements requirements;
    vkGetBufferMemoryRequirements(device.handle(), buffer_, &requirements);
    // The CPU reads uncached memory very slowly.
    memory_ = memory == Memory::device
                  ? device.allocate(requirements, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0, what)
                  : device.allocate(
                        requirements,
                        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                        VK_MEMORY_PROPERTY_HOST_CACHED_BIT, what);
    VK_CHECK(vkBindBufferMemory(device.handle(), buffer_, memory_, 0));
    if (memory == Memory::host)
        VK_CHECK(vkMapMemory(device.handle(), memory_, 0, VK_WHOLE_SIZE, 0, &mapped_));
}

Buffer::~Buffer() {
    if (!device_) return;
    vkDestroyBuffer(device_->handle(), buffer_, nullptr);
    vkFreeMemory(device_->handle(), memory_, nullptr);
}

void Buffer::swap(Buffer& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(buffer_, other.buffer_);
    std::swap(memory_, other.memory_);
    std::swap(mapped_, other.mapped_);
    std::swap(bytes_, other.bytes_);
}

namespace {

VkImageCreateInfo create_info(const ImageInfo& info) {
    return {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
            .flags = info.as_bits ? VkImageCreateFlags{VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT} : 0u,
            .imageType = info.is_3d ? VK_IMAGE_TYPE_3D : VK_IMAGE_TYPE_2D,
            .format = info.format,
            .extent = info.extent,
            .mipLevels = 1,
            .arrayLayers = info.layers,
            .samples = VK_SAMPLE_COUNT_1_BIT,
            .tiling = info.linear ? VK_IMAGE_TILING_LINEAR : VK_IMAGE_TILING_OPTIMAL,
            .usage = info.usage};
}

VkImage create_image(const Device& device, const ImageInfo& info) {
    VkImageCreateInfo create = create_info(info);
    const std::array families{device.queue_family(), device.upload_family()};
    if (info.uploaded && families[0] != families[1]) {
        create.sharingMode = VK_SHARING_MODE_CONCURRENT;
        create.queueFamilyIndexCount = uint32_t(families.size());
        create.pQueueFamilyIndices = families.data();
    }
    VkImage image = VK_NULL_HANDLE;
    VK_CHECK(vkCreateImage(device.handle(), &create, nullptr, &image));
    return image;
}

}  // namespace

std::optional<Texture::Layout> Texture::layout_of(const Device& device, VkImage image,
                                                  const ImageInfo& info) {
    const VkImageSubresource all{.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT};
    VkSubresourceLayout layout;
    vkGetImageSubresourceLayout(device.handle(), image, &all, &layout);
    const VkDeviceSize slice = info.is_3d ? layout.depthPitch : layout.arrayPitch;
    if (layout.offset != 0 || layout.rowPitch % 4 != 0 || slice % 4 != 0) return {};
    return Layout{uint32_t(layout.rowPitch / 4), uint32_t(slice / 4)};
}

Texture::Texture(const Device& device, const ImageInfo& info, const char* what) : Texture() {
    device_ = &device;
    info_ = info;
    image_ = create_image(device, info);
    VkMemoryRequirements requirements;
    vkGetImageMemoryRequirements(device.handle(), image_, &requirements);
    bytes_ = requirements.size;
    if (info.linear) {
        layout_ = layout_of(device, image_, info).value();
        const VkBufferCreateInfo alias{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                       .size = requirements.size,
                                       .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT};
        VK_CHECK(vkCreateBuffer(device.handle(), &alias, nullptr, &buffer_));
        VkMemoryRequirements also;
        vkGetBufferMemoryRequirements(device.handle(), buffer_, &also);
        requirements.size = std::max(requirements.size, also.size);
        requirements.alignment = std::max(requirements.alignment, also.alignment);
        requirements.memoryTypeBits &= also.memoryTypeBits;
    }
    memory_ = device.allocate(requirements, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0, what);
    VK_CHECK(vkBindImageMemory(device.handle(), image_, memory_, 0));
    if (info.linear) VK_CHECK(vkBindBufferMemory(device.handle(), buffer_, memory_, 0));
    const VkImageViewType type = info.is_3d ? VK_IMAGE_VIEW_TYPE_3D : VK_IMAGE_VIEW_TYPE_2D_ARRAY;
    view_ = make_view(type, info.format, 0, info.layers);
    if (info.as_bits) bits_view_ = make_view(type, VK_FORMAT_R32_UINT, 0, info.layers);
    for (uint32_t layer = 0; !info.is_3d && layer < info.layers; ++layer)
        layer_views_.at(layer) = make_view(VK_IMAGE_VIEW_TYPE_2D, info.format, layer, 1);
}

VkImageView Texture::make_view(VkImageViewType type, VkFormat format, uint32_t layer,
                               uint32_t layers) const {
    const VkImageViewCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                     .image = image_,
                                     .viewType = type,
                                     .format = format,
                                     .subresourceRange = {aspect(), 0, 1, layer, layers}};
    VkImageView view = VK_NULL_HANDLE;
    VK_CHECK(vkCreateImageView(device_->handle(), &info, nullptr, &view));
    return view;
}

Texture::~Texture() {
    if (!device_) return;
    for (VkImageView view : layer_views_)
        vkDestroyImageView(device_->handle(), view, nullptr);
    vkDestroyBuffer(device_->handle(), buffer_, nullptr);
    vkDestroyImageView(device_->handle(), bits_view_, nullptr);
    vkDestroyImageView(device_->handle(), view_, nullptr);
    vkDestroyImage(device_->handle(), image_, nullptr);
    vkFreeMemory(device_->handle(), memory_, nullptr);
}

uint64_t Texture::bytes_needed(const Device& device, const ImageInfo& info) {
    const VkImage image = create_image(device, info);
    VkMemoryRequirements requirements;
    vkGetImageMemoryRequirements(device.handle(), image, &requirements);
    vkDestroyImage(device.handle(), image, nullptr);
    return requirements.size;
}

std::optional<Texture::Layout> Texture::linear_layout(const Device& device, ImageInfo info) {
    info.linear = true;
    VkImageFormatProperties most;
    const VkImageCreateInfo wanted = create_info(info);
    if (vkGetPhysicalDeviceImageFormatProperties(device.physical(), wanted.format, wanted.imageType,
                                                 wanted.tiling, wanted.usage, wanted.flags,
                                                 &most) != VK_SUCCESS ||
        info.extent.width > most.maxExtent.width || info.extent.height > most.maxExtent.height ||
        info.extent.depth > most.maxExtent.depth || info.layers > most.maxArrayLayers ||
        bytes_needed(device, info) > device.limits().maxStorageBufferRange)
        return {};
    const VkImage image = create_image(device, info);
    const std::optional<Layout> layout = layout_of(device, image, info);
    vkDestroyImage(device.handle(), image, nullptr);
    return layout;
}

VkImageAspectFlags Texture::aspect() const {
    return info_.format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT
                                                : VK_IMAGE_ASPECT_COLOR_BIT;
}

void Texture::swap(Texture& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(image_, other.image_);
    std::swap(view_, other.view_);
    std::swap(bits_view_, other.bits_view_);
    std::swap(layer_views_, other.layer_views_);
    std::swap(buffer_, other.buffer_);
    std::swap(layout_, other.layout_);
    std::swap(memory_, other.memory_);
    std::swap(info_, other.info_);
    std::swap(bytes_, other.bytes_);
}

Sampler::Sampler(const Device& device) : device_(&device) {
    const VkSamplerCreateInfo info{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                   .magFilter = VK_FILTER_LINEAR,
                                   .minFilter = VK_FILTER_LINEAR,
                                   .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    VK_CHECK(vkCreateSampler(device.handle(), &info, nullptr, &sampler_));
}

Sampler::~Sampler() {
    if (device_) vkDestroySampler(device_->handle(), sampler_, nullptr);
}

void Sampler::swap(Sampler& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(sampler_, other.sampler_);
}

}  // namespace isorast::gpu
