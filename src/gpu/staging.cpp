// SPDX-License-Identifier: MIT
// The ring of staging memory.
#include "gpu/staging.h"

#include "gpu/device.h"
#include "gpu/vulkan_check.h"

namespace isorast::gpu {

// Begins with the constructor that makes nothing: should this one throw, the destructor runs.
Staging::Staging(const Device& device, uint64_t piece_bytes) : Staging(device, Nothing()) {
    piece_bytes_ = piece_bytes;
    const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                       .queueFamilyIndex = device.upload_family()};
    VK_CHECK(vkCreateCommandPool(device.handle(), &pool, nullptr, &pool_));
    for (Piece& piece : pieces_) {
        const VkCommandBufferAllocateInfo buffer{
            .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
            .commandPool = pool_,
            .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
            .commandBufferCount = 1};
        VK_CHECK(vkAllocateCommandBuffers(device.handle(), &buffer, &piece.commands));
        const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
        VK_CHECK(vkCreateFence(device.handle(), &fence, nullptr, &piece.fence));
    }
}

Staging::~Staging() {
    for (Piece& piece : pieces_) {
        if (piece.pending) vkWaitForFences(device_.handle(), 1, &piece.fence, VK_TRUE, UINT64_MAX);
        vkDestroyFence(device_.handle(), piece.fence, nullptr);
    }
    vkDestroyCommandPool(device_.handle(), pool_, nullptr);
}

void Staging::wait(Piece& piece) {
    if (!piece.pending) return;
    VK_CHECK(vkWaitForFences(device_.handle(), 1, &piece.fence, VK_TRUE, UINT64_MAX));
    piece.pending = false;
}

void Staging::wait() {
    for (Piece& piece : pieces_)
        wait(piece);
}

std::byte* Staging::next() {
    current_ = (current_ + 1) % pieces_.size();
    Piece& piece = pieces_[current_];
    wait(piece);
    if (!piece.memory)
        piece.memory = Buffer(device_, piece_bytes_, Buffer::Memory::host, "uploading");
    return piece.memory.data<std::byte>();
}

void Staging::copy_to(const Texture& texture, uint32_t z, uint32_t slices) {
    Piece& piece = pieces_[current_];
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    VK_CHECK(vkBeginCommandBuffer(piece.commands, &begin));
    // Later copies into the image follow this barrier too: it holds for the rest of the queue.
    const VkImageMemoryBarrier discard{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                       .dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                       .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                       .newLayout = VK_IMAGE_LAYOUT_GENERAL,
                                       .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                       .image = texture.handle(),
                                       .subresourceRange = {texture.aspect(), 0, 1, 0, 1}};
    if (z == 0)
        vkCmdPipelineBarrier(piece.commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                             VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0, nullptr, 1,
                             &discard);
    const VkBufferImageCopy region{
        .imageSubresource = {texture.aspect(), 0, 0, 1},
        .imageOffset = {0, 0, int32_t(z)},
        .imageExtent = {texture.extent().width, texture.extent().height, slices}};
    vkCmdCopyBufferToImage(piece.commands, piece.memory.handle(), texture.handle(),
                           VK_IMAGE_LAYOUT_GENERAL, 1, &region);
    VK_CHECK(vkEndCommandBuffer(piece.commands));
    VK_CHECK(vkResetFences(device_.handle(), 1, &piece.fence));
    const VkSubmitInfo submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                              .commandBufferCount = 1,
                              .pCommandBuffers = &piece.commands};
    device_.submit(device_.upload_queue(), submit, piece.fence);
    piece.pending = true;
}

}  // namespace isorast::gpu
