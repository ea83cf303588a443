// SPDX-License-Identifier: MIT
// Staging: a ring of mapped pieces of memory, through which voxels flow into textures on the upload
// queue. While the GPU copies one piece, the next is written.
#pragma once
#include <vulkan/vulkan.h>

#include <array>
#include <cstddef>

#include "gpu/resources.h"

namespace isorast::gpu {

class Staging {
public:
    Staging(const Device& device, uint64_t piece_bytes);
    Staging(const Staging&) = delete;
    Staging& operator=(const Staging&) = delete;
    ~Staging();

    uint64_t piece_bytes() const { return piece_bytes_; }
    // Memory of the next piece, once the GPU has read what was in it.
    std::byte* next();
    // Copies that piece into slices z .. z + slices - 1 of a 3D image; from z = 0 on, first
    // discards what the image held. No frame that uses the image may be in flight.
    void copy_to(const Texture& texture, uint32_t z, uint32_t slices);
    // Until all copies are done: then frames submitted later see them.
    void wait();

private:
    struct Piece {
        Buffer memory;  // made when first used
        VkCommandBuffer commands = VK_NULL_HANDLE;
        VkFence fence = VK_NULL_HANDLE;
        bool pending = false;
    };
    struct Nothing {};
    Staging(const Device& device, Nothing) : device_(device) {}
    void wait(Piece& piece);

    const Device& device_;
    uint64_t piece_bytes_ = 0;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    std::array<Piece, 4> pieces_;
    size_t current_ = 0;
};

}  // namespace isorast::gpu
