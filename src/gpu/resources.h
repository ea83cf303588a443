// SPDX-License-Identifier: MIT
// Buffers, images and samplers: move-only owners, each with its own memory. Images live in GENERAL
// layout.
#pragma once
#include <vulkan/vulkan.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

namespace isorast::gpu {

class Device;

class Buffer {
public:
    enum class Memory : uint8_t {
        device,
        host
    };  // host: visible, coherent, mapped for its whole life

    Buffer() = default;
    // Usable as storage, uniform, indirect, and for transfers both ways.
    Buffer(const Device& device, uint64_t bytes, Memory memory, const char* what);
    Buffer(Buffer&& other) noexcept { swap(other); }
    Buffer& operator=(Buffer&& other) noexcept {
        swap(other);
        return *this;
    }
    ~Buffer();

    VkBuffer handle() const { return buffer_; }
    uint64_t bytes() const { return bytes_; }
    template <class T>
    T* data() const {
        return static_cast<T*>(mapped_);
    }
    explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }

private:
    void swap(Buffer& other) noexcept;
    const Device* device_ = nullptr;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    void* mapped_ = nullptr;
    uint64_t bytes_ = 0;
};

struct ImageInfo {
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent3D extent{1, 1, 1};
    VkImageUsageFlags usage = 0;
    bool is_3d = false;
    uint32_t layers = 1;    // of a 2D image, which is an array to all shaders; at most 2
    bool uploaded = false;  // written on the upload queue too
    bool as_bits = false;   // 32-bit texels that can be seen as R32_UINT too, for atomics
    bool linear = false;    // rows of texels in memory that is a buffer too; Texture::buffer
};

class Texture {
public:
    Texture() = default;
    Texture(const Device& device, const ImageInfo& info, const char* what);
    Texture(Texture&& other) noexcept { swap(other); }
    Texture& operator=(Texture&& other) noexcept {
        swap(other);
        return *this;
    }
    ~Texture();

    // The bytes that such an image needs on the device, without making one.
    static uint64_t bytes_needed(const Device& device, const ImageInfo& info);
    // For ImageInfo::linear: how rows, and slices or layers, lie in the buffer, all on whole 32-bit
    // words; nothing if the device has no such image, or no buffer as large.
    struct Layout {
        uint32_t row_words = 0, slice_words = 0;
    };
    static std::optional<Layout> linear_layout(const Device& device, ImageInfo info);

    VkImage handle() const { return image_; }
    VkImageView view() const { return view_; }            // of a volume, or an array of all layers
    VkImageView bits_view() const { return bits_view_; }  // the same; ImageInfo::as_bits
    VkImageView layer_view(uint32_t layer) const { return layer_views_.at(layer); }  // a 2D image
    uint32_t layers() const { return info_.layers; }
    VkFormat format() const { return info_.format; }
    VkExtent3D extent() const { return info_.extent; }
    VkImageAspectFlags aspect() const;
    uint64_t bytes() const { return bytes_; }
    VkBuffer buffer() const { return buffer_; }  // the same memory; ImageInfo::linear
    Layout layout() const { return layout_; }    // of that
    explicit operator bool() const { return image_ != VK_NULL_HANDLE; }

private:
    static std::optional<Layout> layout_of(const Device& device, VkImage image,
                                           const ImageInfo& info);
    VkImageView make_view(VkImageViewType type, VkFormat format, uint32_t layer,
                          uint32_t layers) const;
    void swap(Texture& other) noexcept;
    const Device* device_ = nullptr;
    VkImage image_ = VK_NULL_HANDLE;
    VkImageView view_ = VK_NULL_HANDLE, bits_view_ = VK_NULL_HANDLE;
    std::array<VkImageView, 2> layer_views_{};
    VkBuffer buffer_ = VK_NULL_HANDLE;
    Layout layout_;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    ImageInfo info_;
    uint64_t bytes_ = 0;
};

class Sampler {
public:
    Sampler() = default;
    explicit Sampler(const Device& device);  // trilinear, clamped to the edge
    Sampler(Sampler&& other) noexcept { swap(other); }
    Sampler& operator=(Sampler&& other) noexcept {
        swap(other);
        return *this;
    }
    ~Sampler();
    VkSampler handle() const { return sampler_; }

private:
    void swap(Sampler& other) noexcept;
    const Device* device_ = nullptr;
    VkSampler sampler_ = VK_NULL_HANDLE;
};

}  // namespace isorast::gpu
