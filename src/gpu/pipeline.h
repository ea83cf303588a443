// SPDX-License-Identifier: MIT
// Pipelines: SPIR-V, the kinds of a pass's bindings, specialization constants. Set 0 is the scene's
// (src/grid/grid.h), the same for every pipeline; set 1 is the pass's own, in the order given.
#pragma once
#include <vulkan/vulkan.h>

#include <cstdint>
#include <span>
#include <vector>

namespace isorast::gpu {

class Device;

enum class Kind : uint8_t {
    buffer,
    texture,
    image
};  // storage buffer, sampled image, storage image

struct Shader {
    VkShaderStageFlagBits stage;
    std::span<const uint32_t> spirv;
};

struct PipelineInfo {
    const char* name = "";  // in debuggers and messages of the validation layer
    VkDescriptorSetLayout scene_layout = VK_NULL_HANDLE;
    std::vector<Kind> bindings;
    uint32_t push_bytes = 0;
    std::vector<uint32_t> constants;  // specialization constants 0, 1, 2, ...
};

// What a graphics pipeline draws into.
struct Attachments {
    std::vector<VkFormat> colors;
    VkFormat depth = VK_FORMAT_UNDEFINED;
    bool writes_depth = true;
    uint32_t layers = 1;          // as the images have
    bool representative = false;  // one fragment that passes stands for its primitive
};

class Pipeline {
public:
    Pipeline() = default;
    static Pipeline compute(const Device& device, const PipelineInfo& info,
                            std::span<const uint32_t> spirv);
    // Task + mesh (+ fragment), or vertex + fragment: three vertices, no vertex input. Depth test:
    // greater, reversed depth. Both faces are drawn.
    static Pipeline graphics(const Device& device, const PipelineInfo& info,
                             const std::vector<Shader>& shaders, const Attachments& attachments);
    Pipeline(Pipeline&& other) noexcept { swap(other); }
    Pipeline& operator=(Pipeline&& other) noexcept {
        swap(other);
        return *this;
    }
    ~Pipeline();

    VkPipeline handle() const { return pipeline_; }
    VkPipelineLayout layout() const { return layout_; }
    VkDescriptorSetLayout set_layout() const { return set_layout_; }
    VkPipelineBindPoint bind_point() const { return bind_point_; }
    VkShaderStageFlags stages() const { return stages_; }
    const std::vector<Kind>& bindings() const { return bindings_; }
    explicit operator bool() const { return pipeline_ != VK_NULL_HANDLE; }

private:
    Pipeline(const Device& device, const PipelineInfo& info, VkShaderStageFlags stages);
    void set_name(const char* name) const;
    void swap(Pipeline& other) noexcept;
    const Device* device_ = nullptr;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    VkPipelineBindPoint bind_point_ = VK_PIPELINE_BIND_POINT_COMPUTE;
    VkShaderStageFlags stages_ = 0;
    std::vector<Kind> bindings_;
};

VkDescriptorType descriptor_type(Kind kind);

}  // namespace isorast::gpu
