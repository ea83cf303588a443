// SPDX-License-Identifier: MIT
// Device: the Vulkan instance, physical device, logical device and queue that everything else uses.
#pragma once
#include <isorast/gpu.h>
#include <vulkan/vulkan.h>

#include <mutex>
#include <optional>

namespace isorast::gpu {

// What is enabled on the device, not only what it could do.
struct Features {
    bool storage_16bit = false;        // required: min-max nodes, places in rows of vertices
    bool nonuniform_textures = false;  // volumes of several bricks
    bool mesh_shaders = false;
    bool mesh_multiview = false;  // mesh shaders draw both eyes as views
    bool dynamic_rendering = false;
    bool storage_without_format = false;  // formulas sampled on the GPU
    bool fragment_stores = false;         // occlusion tests by raster proxies
    bool representative_test = false;     // the same, faster: VK_NV_representative_fragment_test
};

// How one pass draws into a target: for one eye, or for both: primitives that name their layer, or
// views of one drawing.
enum class Eyes : uint8_t { one, layers, views };

// Extension functions, loaded by hand.
struct Functions {
    PFN_vkCmdDrawMeshTasksIndirectEXT draw_mesh_tasks_indirect = nullptr;
    PFN_vkCmdBeginRendering begin_rendering = nullptr;
    PFN_vkCmdEndRendering end_rendering = nullptr;
    PFN_vkSetDebugUtilsObjectNameEXT set_name = nullptr;
    PFN_vkCmdBeginDebugUtilsLabelEXT begin_label = nullptr;
    PFN_vkCmdEndDebugUtilsLabelEXT end_label = nullptr;
};

class Device {
public:
    explicit Device(const GpuOptions& options);
    explicit Device(const HostDevice& host);
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    ~Device();

    VkDevice handle() const { return device_; }
    VkPhysicalDevice physical() const { return physical_; }
    VkQueue queue() const { return queue_; }
    uint32_t queue_family() const { return queue_family_; }
    // Where uploads go: a copy engine of its own where the device has one, else queue().
    VkQueue upload_queue() const { return upload_queue_; }
    uint32_t upload_family() const { return upload_family_; }
    // False where only the host may say when its queue is used.
    bool can_upload_in_background() const { return owned_ || upload_queue_ != queue_; }
    // To queue() or upload_queue(), from any thread.
    void submit(VkQueue queue, const VkSubmitInfo& info, VkFence fence) const;
    bool has_graphics() const { return has_graphics_; }
    const VkPhysicalDeviceLimits& limits() const { return properties_.limits; }
    const Features& features() const { return features_; }
    const Functions& functions() const { return functions_; }
    const DeviceInfo& info() const { return info_; }
    bool is_cpu() const { return properties_.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }
    // Whether workgroups of so many threads run in lockstep: as one subgroup, each instruction for
    // all of it, as CPU drivers do.
    bool in_lockstep(uint32_t threads) const { return is_cpu() && threads == info_.subgroup_size; }
    Eyes eyes(uint32_t layers) const {
        if (layers == 1) return Eyes::one;
        return features_.mesh_multiview ? Eyes::views : Eyes::layers;
    }
    uint32_t view_mask(uint32_t layers) const { return eyes(layers) == Eyes::views ? 3 : 0; }
    uint64_t max_allocation() const { return info_.max_allocation_bytes; }
    // Bits of a timestamp that count; 0 when the queue has none.
    uint32_t timestamp_bits() const { return timestamp_bits_; }

    // Allocates for `requirements` in memory that has all of `wanted`, and of `preferred` too where
    // there is such.
    VkDeviceMemory allocate(const VkMemoryRequirements& requirements, VkMemoryPropertyFlags wanted,
                            VkMemoryPropertyFlags preferred, const char* what) const;
    std::vector<std::string> messages() const;

private:
    Device() = default;  // the constructors begin with this one: should they throw, ~Device() runs
    void create_instance(bool validation);
    void create_device();
    void adopt_physical();
    void load_functions();

    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE, upload_queue_ = VK_NULL_HANDLE;
    uint32_t queue_family_ = 0, upload_family_ = 0, timestamp_bits_ = 0;
    mutable std::mutex submit_mutex_;
    bool owned_ = true, has_graphics_ = false, debug_utils_ = false;
    VkPhysicalDeviceProperties properties_{};
    VkPhysicalDeviceMemoryProperties memory_{};
    Features features_;
    Functions functions_;
    DeviceInfo info_;

public:
    // Kept here for choose_rasterizer().
    mutable std::optional<RasterizerChoice> rasterizer_choice;
    // For the messenger's callback only.
    mutable std::mutex messages_mutex;
    std::vector<std::string> validation_messages;
};

}  // namespace isorast::gpu
