// SPDX-License-Identifier: MIT
// Recording of passes, and their submission.
#include "gpu/commands.h"

#include <array>
#include <cassert>

#include "gpu/device.h"
#include "gpu/vulkan_check.h"

namespace isorast::gpu {

namespace {

constexpr uint32_t MAX_SETS = 512;     // binds in one frame; a pass and surface each need one
constexpr uint32_t MAX_QUERIES = 512;  // two a pass

}  // namespace

// Constructors begin with those that make nothing: should they throw, destructors run.
Slot::Slot(const Device& device) : Slot(device, Nothing()) {
    const std::array sizes{VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 8 * MAX_SETS},
                           VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 8},
                           VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, 2 * MAX_SETS},
                           VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_SAMPLER, 8},
                           VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 4 * MAX_SETS}};
    const VkDescriptorPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                          .maxSets = MAX_SETS,
                                          .poolSizeCount = uint32_t(sizes.size()),
                                          .pPoolSizes = sizes.data()};
    VK_CHECK(vkCreateDescriptorPool(device.handle(), &pool, nullptr, &pool_));
    if (device.timestamp_bits() == 0) return;
    const VkQueryPoolCreateInfo queries{.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                        .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                        .queryCount = MAX_QUERIES};
    VK_CHECK(vkCreateQueryPool(device.handle(), &queries, nullptr, &queries_));
}

Slot::~Slot() {
    vkDestroyQueryPool(device_.handle(), queries_, nullptr);
    vkDestroyDescriptorPool(device_.handle(), pool_, nullptr);
}

void Slot::reset() {
    VK_CHECK(vkResetDescriptorPool(device_.handle(), pool_, 0));
    names_.clear();
}

std::vector<TimedPass> Slot::times() const {
    std::vector<TimedPass> passes;
    if (!queries_ || names_.empty()) return passes;
    std::vector<uint64_t> ticks(2 * names_.size());
    VK_CHECK(vkGetQueryPoolResults(device_.handle(), queries_, 0, uint32_t(ticks.size()),
                                   ticks.size() * sizeof(uint64_t), ticks.data(), sizeof(uint64_t),
                                   VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT));
    const uint32_t bits = device_.timestamp_bits();
    const uint64_t mask = bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
    const double tick_ms = double(device_.limits().timestampPeriod) * 1e-6;
    for (size_t i = 0; i < names_.size(); ++i) {
        const auto since_start = [&](uint64_t tick) {
            return double((tick - ticks[0]) & mask) * tick_ms;
        };
        passes.push_back({names_[i], since_start(ticks[2 * i]), since_start(ticks[2 * i + 1])});
    }
    return passes;
}

Commands::Commands(const Device& device, VkCommandBuffer commands, Slot& slot)
    : device_(device), commands_(commands), slot_(slot) {
    if (slot.queries_) vkCmdResetQueryPool(commands, slot.queries_, 0, MAX_QUERIES);
}

Commands::Pass::Pass(Commands& commands, const char* name)
    : commands_(commands), query_(uint32_t(2 * commands.slot_.names_.size())) {
    const VkDebugUtilsLabelEXT label{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT,
                                     .pLabelName = name};
    if (auto* begin_label = commands.device_.functions().begin_label)
        begin_label(commands.commands_, &label);
    if (query_ + 2 > MAX_QUERIES) return;
    commands.slot_.names_.emplace_back(name);
    if (commands.slot_.queries_)
        vkCmdWriteTimestamp(commands.commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT,
                            commands.slot_.queries_, query_);
}

Commands::Pass::~Pass() {
    if (commands_.slot_.queries_ && query_ + 2 <= MAX_QUERIES)
        vkCmdWriteTimestamp(commands_.commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT,
                            commands_.slot_.queries_, query_ + 1);
    if (auto* end_label = commands_.device_.functions().end_label) end_label(commands_.commands_);
}

void Commands::barrier() {
    const VkMemoryBarrier memory{
        .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT};
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 1, &memory, 0, nullptr, 0, nullptr);
}

void Commands::discard_to_general(const Texture& texture) {
    const VkImageMemoryBarrier barrier{
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout = VK_IMAGE_LAYOUT_GENERAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = texture.handle(),
        .subresourceRange = {texture.aspect(), 0, 1, 0, texture.layers()}};
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr, 0, nullptr, 1,
                         &barrier);
}

void Commands::update(const Buffer& buffer, uint64_t offset, const void* data, uint64_t bytes) {
    vkCmdUpdateBuffer(commands_, buffer.handle(), offset, bytes, data);
}

void Commands::copy(const Buffer& from, uint64_t from_offset, const Buffer& to, uint64_t to_offset,
                    uint64_t bytes) {
    const VkBufferCopy region{from_offset, to_offset, bytes};
    vkCmdCopyBuffer(commands_, from.handle(), to.handle(), 1, &region);
}

void Commands::fill(const Buffer& buffer, uint32_t value) {
    vkCmdFillBuffer(commands_, buffer.handle(), 0, VK_WHOLE_SIZE, value);
}

void Commands::clear(const Texture& texture, const VkClearColorValue& color) {
    const VkImageSubresourceRange whole{texture.aspect(), 0, 1, 0, texture.layers()};
    vkCmdClearColorImage(commands_, texture.handle(), VK_IMAGE_LAYOUT_GENERAL, &color, 1, &whole);
}

void Commands::copy_to_buffer(const Texture& from, const Buffer& to) {
    const VkBufferImageCopy region{.imageSubresource = {from.aspect(), 0, 0, from.layers()},
                                   .imageExtent = from.extent()};
    vkCmdCopyImageToBuffer(commands_, from.handle(), VK_IMAGE_LAYOUT_GENERAL, to.handle(), 1,
                           &region);
}

void Commands::copy_to_image(const Buffer& from, const Texture& to) {
    const VkBufferImageCopy region{.imageSubresource = {to.aspect(), 0, 0, to.layers()},
                                   .imageExtent = to.extent()};
    vkCmdCopyBufferToImage(commands_, from.handle(), to.handle(), VK_IMAGE_LAYOUT_GENERAL, 1,
                           &region);
}

VkDescriptorSet Commands::allocate_set(VkDescriptorSetLayout layout) {
    const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                           .descriptorPool = slot_.pool_,
                                           .descriptorSetCount = 1,
                                           .pSetLayouts = &layout};
    VkDescriptorSet set = VK_NULL_HANDLE;
    VK_CHECK(vkAllocateDescriptorSets(device_.handle(), &info, &set));
    return set;
}

void Commands::bind(const Pipeline& pipeline, std::initializer_list<Binding> bindings) {
    assert(bindings.size() == pipeline.bindings().size());
    const VkDescriptorSet set = allocate_set(pipeline.set_layout());
    std::vector<VkDescriptorBufferInfo> buffers(bindings.size());
    std::vector<VkDescriptorImageInfo> images(bindings.size());
    std::vector<VkWriteDescriptorSet> writes;
    for (uint32_t i = 0; const Binding& binding : bindings) {
        buffers[i] = {binding.buffer, 0, VK_WHOLE_SIZE};
        images[i] = {VK_NULL_HANDLE, binding.view, VK_IMAGE_LAYOUT_GENERAL};
        writes.push_back({.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                          .dstSet = set,
                          .dstBinding = i,
                          .descriptorCount = 1,
                          .descriptorType = descriptor_type(pipeline.bindings()[i]),
                          .pImageInfo = &images[i],
                          .pBufferInfo = &buffers[i]});
        ++i;
    }
    vkUpdateDescriptorSets(device_.handle(), uint32_t(writes.size()), writes.data(), 0, nullptr);
    vkCmdBindPipeline(commands_, pipeline.bind_point(), pipeline.handle());
    const std::array sets{scene_, set};
    vkCmdBindDescriptorSets(commands_, pipeline.bind_point(), pipeline.layout(), 0,
                            uint32_t(sets.size()), sets.data(), 0, nullptr);
    bound_ = &pipeline;
}

void Commands::push(const void* data, uint32_t bytes) {
    vkCmdPushConstants(commands_, bound_->layout(), bound_->stages(), 0, bytes, data);
}

void Commands::dispatch(uint32_t x, uint32_t y, uint32_t z) {
    vkCmdDispatch(commands_, x, y, z);
}

void Commands::dispatch_indirect(const Buffer& arguments, uint64_t offset) {
    vkCmdDispatchIndirect(commands_, arguments.handle(), offset);
}

void Commands::draw(uint32_t vertices) {
    vkCmdDraw(commands_, vertices, 1, 0, 0);
}

void Commands::draw_mesh_tasks_indirect(const Buffer& arguments, uint64_t offset) {
    device_.functions().draw_mesh_tasks_indirect(commands_, arguments.handle(), offset, 1,
                                                 sizeof(VkDrawMeshTasksIndirectCommandEXT));
}

void Commands::begin_rendering(const std::vector<const Texture*>& colors, const Texture* depth,
                               bool clear, const VkClearColorValue& color,
                               std::optional<uint32_t> layer) {
    const auto attachment = [&](const Texture& texture, const VkClearValue& value) {
        return VkRenderingAttachmentInfo{
            .sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO,
            .imageView = layer ? texture.layer_view(*layer) : texture.view(),
            .imageLayout = VK_IMAGE_LAYOUT_GENERAL,
            .loadOp = clear ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD,
            .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
            .clearValue = value};
    };
    std::vector<VkRenderingAttachmentInfo> color_infos;
    for (const Texture* texture : colors)
        color_infos.push_back(attachment(*texture, {.color = color}));
    const VkExtent3D size = depth->extent();
    const auto depth_info = attachment(*depth, {.depthStencil = {0, 0}});
    const VkRenderingInfo info{.sType = VK_STRUCTURE_TYPE_RENDERING_INFO,
                               .renderArea = {{0, 0}, {size.width, size.height}},
                               .layerCount = layer ? 1 : depth->layers(),
                               .viewMask = layer ? 0 : device_.view_mask(depth->layers()),
                               .colorAttachmentCount = uint32_t(color_infos.size()),
                               .pColorAttachments = color_infos.data(),
                               .pDepthAttachment = &depth_info};
    device_.functions().begin_rendering(commands_, &info);
    const VkViewport viewport{0, 0, float(size.width), float(size.height), 0, 1};
    vkCmdSetViewport(commands_, 0, 1, &viewport);
    vkCmdSetScissor(commands_, 0, 1, &info.renderArea);
}

void Commands::end_rendering() {
    device_.functions().end_rendering(commands_);
}

Submission::Submission(const Device& device) : Submission(device, Nothing()) {
    const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                       .queueFamilyIndex = device.queue_family()};
    VK_CHECK(vkCreateCommandPool(device.handle(), &pool, nullptr, &pool_));
    const VkCommandBufferAllocateInfo buffer{
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = pool_,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 1};
    VK_CHECK(vkAllocateCommandBuffers(device.handle(), &buffer, &commands_));
    const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    VK_CHECK(vkCreateFence(device.handle(), &fence, nullptr, &fence_));
}

Submission::~Submission() {
    if (pending_) vkWaitForFences(device_.handle(), 1, &fence_, VK_TRUE, UINT64_MAX);
    vkDestroyFence(device_.handle(), fence_, nullptr);
    vkDestroyCommandPool(device_.handle(), pool_, nullptr);
}

Commands Submission::begin() {
    wait();
    slot_.reset();
    VK_CHECK(vkResetCommandBuffer(commands_, 0));  // an error may have ended its recording half way
    const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    VK_CHECK(vkBeginCommandBuffer(commands_, &info));
    return {device_, commands_, slot_};
}

void Submission::submit() {
    // What the commands wrote into host memory must be visible to the host once the fence is.
    const VkMemoryBarrier to_host{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                  .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                  .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                         0, 1, &to_host, 0, nullptr, 0, nullptr);
    VK_CHECK(vkEndCommandBuffer(commands_));
    VK_CHECK(vkResetFences(device_.handle(), 1, &fence_));
    const VkSubmitInfo info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                            .commandBufferCount = 1,
                            .pCommandBuffers = &commands_};
    device_.submit(device_.queue(), info, fence_);
    pending_ = true;
}

void Submission::wait() {
    if (!pending_) return;
    VK_CHECK(vkWaitForFences(device_.handle(), 1, &fence_, VK_TRUE, UINT64_MAX));
    pending_ = false;
}

}  // namespace isorast::gpu
