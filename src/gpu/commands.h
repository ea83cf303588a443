// SPDX-License-Identifier: MIT
// Recording: named and timed passes, bindings by value, one blunt barrier. Slot: what one recorded
// frame needs until it has run (descriptors, timestamps).
#pragma once
#include <vulkan/vulkan.h>

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "gpu/pipeline.h"
#include "gpu/resources.h"

namespace isorast::gpu {

class Device;

// A resource for a pass's binding; see Pipeline's Kind.
struct Binding {
    Binding(const Buffer& from) : buffer(from.handle()) {}  // NOLINT(google-explicit-constructor)
    Binding(const Texture& from) : view(from.view()) {}     // NOLINT(google-explicit-constructor)
    explicit Binding(VkImageView from) : view(from) {}
    explicit Binding(VkBuffer from) : buffer(from) {}
    VkBuffer buffer = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
};

struct TimedPass {
    std::string name;
    double begin_ms = 0, end_ms = 0;
};

// Transient resources of one recording; reset() when its commands have finished on the GPU.
class Slot {
public:
    explicit Slot(const Device& device);
    Slot(const Slot&) = delete;
    Slot& operator=(const Slot&) = delete;
    ~Slot();
    void reset();
    // GPU times of the passes recorded since reset(); their commands must have finished.
    std::vector<TimedPass> times() const;

private:
    friend class Commands;
    struct Nothing {};
    Slot(const Device& device, Nothing) : device_(device) {}
    const Device& device_;
    VkDescriptorPool pool_ = VK_NULL_HANDLE;
    VkQueryPool queries_ = VK_NULL_HANDLE;
    std::vector<std::string> names_;
};

class Commands {
public:
    Commands(const Device& device, VkCommandBuffer commands, Slot& slot);

    // A named, timed pass that lasts as long as the returned object.
    class Pass {
    public:
        Pass(Commands& commands, const char* name);
        Pass(const Pass&) = delete;
        Pass& operator=(const Pass&) = delete;
        ~Pass();

    private:
        Commands& commands_;
        uint32_t query_;
    };
    [[nodiscard]] Pass pass(const char* name) { return Pass(*this, name); }

    // Everything before is done and visible before anything after begins.
    void barrier();
    // Makes the image usable in GENERAL layout; its content is lost.
    void discard_to_general(const Texture& texture);

    // `data` is at most 64 KiB, a multiple of 4 bytes.
    void update(const Buffer& buffer, uint64_t offset, const void* data, uint64_t bytes);
    void copy(const Buffer& from, uint64_t from_offset, const Buffer& to, uint64_t to_offset,
              uint64_t bytes);
    void fill(const Buffer& buffer, uint32_t value);
    void clear(const Texture& texture, const VkClearColorValue& color);  // not a depth image
    // All layers, one after the other, tightly packed.
    void copy_to_buffer(const Texture& from, const Buffer& to);
    void copy_to_image(const Buffer& from, const Texture& to);  // the way back

    void set_scene(VkDescriptorSet scene) { scene_ = scene; }
    VkDescriptorSet allocate_set(VkDescriptorSetLayout layout);
    void bind(const Pipeline& pipeline, std::initializer_list<Binding> bindings);
    // After bind(): push constants of the bound pipeline.
    template <class T>
    void push(const T& constants) {
        push(&constants, sizeof(T));
    }

    void dispatch(uint32_t x, uint32_t y = 1, uint32_t z = 1);
    void dispatch_indirect(const Buffer& arguments, uint64_t offset);
    void draw(uint32_t vertices);
    void draw_mesh_tasks_indirect(const Buffer& arguments, uint64_t offset);

    // Rendering into attachments, cleared first (depth to 0, far) or kept: into one layer, or into
    // all, where primitives choose theirs.
    void begin_rendering(const std::vector<const Texture*>& colors, const Texture* depth,
                         bool clear, const VkClearColorValue& color = {},
                         std::optional<uint32_t> layer = {});
    void end_rendering();

    VkCommandBuffer handle() const { return commands_; }

private:
    void push(const void* data, uint32_t bytes);
    const Device& device_;
    VkCommandBuffer commands_;
    Slot& slot_;
    VkDescriptorSet scene_ = VK_NULL_HANDLE;
    const Pipeline* bound_ = nullptr;
};

// Records with `record(Commands&)`, submits, and waits: for uploads and tests, not for frames.
template <class Record>
void run_once(const Device& device, Record&& record);

// A command pool with one buffer, a slot and a fence: one frame that may be in flight.
class Submission {
public:
    explicit Submission(const Device& device);
    Submission(const Submission&) = delete;
    Submission& operator=(const Submission&) = delete;
    ~Submission();
    Commands begin();  // waits for the previous use first
    void submit();
    void wait();
    Slot& slot() { return slot_; }

private:
    struct Nothing {};
    Submission(const Device& device, Nothing) : device_(device), slot_(device) {}
    const Device& device_;
    Slot slot_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    VkFence fence_ = VK_NULL_HANDLE;
    bool pending_ = false;
};

template <class Record>
void run_once(const Device& device, Record&& record) {
    Submission submission(device);
    Commands commands = submission.begin();
    record(commands);
    submission.submit();
    submission.wait();
}

}  // namespace isorast::gpu
