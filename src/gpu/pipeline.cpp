// SPDX-License-Identifier: MIT
// Pipelines from SPIR-V.
#include "gpu/pipeline.h"

#include <array>
#include <utility>

#include "gpu/device.h"
#include "gpu/vulkan_check.h"

namespace isorast::gpu {

namespace {

// A shader module that lives until the pipeline is made.
class Module {
public:
    Module(const Device& device, std::span<const uint32_t> spirv) : device_(device) {
        const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                            .codeSize = spirv.size_bytes(),
                                            .pCode = spirv.data()};
        VK_CHECK(vkCreateShaderModule(device.handle(), &info, nullptr, &module_));
    }
    Module(const Module&) = delete;
    Module& operator=(const Module&) = delete;
    Module(Module&& other) noexcept
        : device_(other.device_), module_(std::exchange(other.module_, nullptr)) {}
    ~Module() { vkDestroyShaderModule(device_.handle(), module_, nullptr); }
    VkShaderModule handle() const { return module_; }

private:
    const Device& device_;
    VkShaderModule module_ = VK_NULL_HANDLE;
};

// Specialization constants 0, 1, 2, ... of 4 bytes each.
struct Specialization {
    explicit Specialization(const std::vector<uint32_t>& constants) {
        for (uint32_t i = 0; i < constants.size(); ++i)
            entries.push_back({i, 4 * i, 4});
        info = {uint32_t(entries.size()), entries.data(), 4 * constants.size(), constants.data()};
    }
    std::vector<VkSpecializationMapEntry> entries;
    VkSpecializationInfo info;
};

VkPipelineShaderStageCreateInfo stage_info(VkShaderStageFlagBits stage, const Module& module,
                                           const Specialization& specialization) {
    return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = stage,
            .module = module.handle(),
            .pName = "main",
            .pSpecializationInfo = &specialization.info};
}

}  // namespace

VkDescriptorType descriptor_type(Kind kind) {
    switch (kind) {
        case Kind::buffer:
            return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        case Kind::texture:
            return VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
        case Kind::image:
            return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    }
    return VK_DESCRIPTOR_TYPE_MAX_ENUM;
}

// Begins with the constructor that has nothing: should this one throw, the destructor runs.
Pipeline::Pipeline(const Device& device, const PipelineInfo& info, VkShaderStageFlags stages)
    : Pipeline() {
    device_ = &device;
    stages_ = stages;
    bindings_ = info.bindings;
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (uint32_t i = 0; i < bindings_.size(); ++i)
        bindings.push_back({i, descriptor_type(bindings_[i]), 1, stages, nullptr});
    const VkDescriptorSetLayoutCreateInfo set{
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
        .bindingCount = uint32_t(bindings.size()),
        .pBindings = bindings.data()};
    VK_CHECK(vkCreateDescriptorSetLayout(device.handle(), &set, nullptr, &set_layout_));
    const std::array sets{info.scene_layout, set_layout_};
    const VkPushConstantRange push{stages, 0, info.push_bytes};
    const VkPipelineLayoutCreateInfo layout{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                            .setLayoutCount = uint32_t(sets.size()),
                                            .pSetLayouts = sets.data(),
                                            .pushConstantRangeCount = info.push_bytes ? 1u : 0u,
                                            .pPushConstantRanges = &push};
    VK_CHECK(vkCreatePipelineLayout(device.handle(), &layout, nullptr, &layout_));
}

Pipeline Pipeline::compute(const Device& device, const PipelineInfo& info,
                           std::span<const uint32_t> spirv) {
    Pipeline pipeline(device, info, VK_SHADER_STAGE_COMPUTE_BIT);
    const Module module(device, spirv);
    const Specialization specialization(info.constants);
    const VkComputePipelineCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = stage_info(VK_SHADER_STAGE_COMPUTE_BIT, module, specialization),
        .layout = pipeline.layout_};
    VK_CHECK(vkCreateComputePipelines(device.handle(), nullptr, 1, &create, nullptr,
                                      &pipeline.pipeline_));
    pipeline.set_name(info.name);
    return pipeline;
}

Pipeline Pipeline::graphics(const Device& device, const PipelineInfo& info,
                            const std::vector<Shader>& shaders, const Attachments& attachments) {
    VkShaderStageFlags stages = 0;
    for (const Shader& shader : shaders)
        stages |= shader.stage;
    Pipeline pipeline(device, info, stages);
    pipeline.bind_point_ = VK_PIPELINE_BIND_POINT_GRAPHICS;

    std::vector<Module> modules;
    std::vector<VkPipelineShaderStageCreateInfo> stage_infos;
    const Specialization specialization(info.constants);
    for (const Shader& shader : shaders) {
        modules.emplace_back(device, shader.spirv);
        stage_infos.push_back(stage_info(shader.stage, modules.back(), specialization));
    }
    const VkPipelineVertexInputStateCreateInfo no_vertices{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    const VkPipelineInputAssemblyStateCreateInfo triangles{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    const VkPipelineViewportStateCreateInfo viewport{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo rasterization{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = VK_CULL_MODE_NONE,
        .lineWidth = 1};
    const VkPipelineMultisampleStateCreateInfo one_sample{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    const VkPipelineDepthStencilStateCreateInfo depth{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = VK_TRUE,
        .depthWriteEnable = attachments.writes_depth,
        .depthCompareOp = VK_COMPARE_OP_GREATER};
    const std::vector<VkPipelineColorBlendAttachmentState> blends(
        attachments.colors.size(), VkPipelineColorBlendAttachmentState{.colorWriteMask = 0xf});
    const VkPipelineColorBlendStateCreateInfo blend{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = uint32_t(blends.size()),
        .pAttachments = blends.data()};
    const std::array dynamics{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    const VkPipelineDynamicStateCreateInfo dynamic{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = uint32_t(dynamics.size()),
        .pDynamicStates = dynamics.data()};
    const VkPipelineRepresentativeFragmentTestStateCreateInfoNV representative{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_REPRESENTATIVE_FRAGMENT_TEST_STATE_CREATE_INFO_NV,
        .representativeFragmentTestEnable = VK_TRUE};
    const VkPipelineRenderingCreateInfo rendering{
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
        .pNext = attachments.representative ? &representative : nullptr,
        .viewMask = device.view_mask(attachments.layers),
        .colorAttachmentCount = uint32_t(attachments.colors.size()),
        .pColorAttachmentFormats = attachments.colors.data(),
        .depthAttachmentFormat = attachments.depth};
    const VkGraphicsPipelineCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
        .pNext = &rendering,
        .stageCount = uint32_t(stage_infos.size()),
        .pStages = stage_infos.data(),
        .pVertexInputState = &no_vertices,
        .pInputAssemblyState = &triangles,
        .pViewportState = &viewport,
        .pRasterizationState = &rasterization,
        .pMultisampleState = &one_sample,
        .pDepthStencilState = &depth,
        .pColorBlendState = &blend,
        .pDynamicState = &dynamic,
        .layout = pipeline.layout_};
    VK_CHECK(vkCreateGraphicsPipelines(device.handle(), nullptr, 1, &create, nullptr,
                                       &pipeline.pipeline_));
    pipeline.set_name(info.name);
    return pipeline;
}

void Pipeline::set_name(const char* name) const {
    const VkDebugUtilsObjectNameInfoEXT info{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
        .objectType = VK_OBJECT_TYPE_PIPELINE,
        .objectHandle = reinterpret_cast<uint64_t>(pipeline_),
        .pObjectName = name};
    if (auto* set = device_->functions().set_name) VK_CHECK(set(device_->handle(), &info));
}

Pipeline::~Pipeline() {
    if (!device_) return;
    vkDestroyPipeline(device_->handle(), pipeline_, nullptr);
    vkDestroyPipelineLayout(device_->handle(), layout_, nullptr);
    vkDestroyDescriptorSetLayout(device_->handle(), set_layout_, nullptr);
}

void Pipeline::swap(Pipeline& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(set_layout_, other.set_layout_);
    std::swap(layout_, other.layout_);
    std::swap(pipeline_, other.pipeline_);
    std::swap(bind_point_, other.bind_point_);
    std::swap(stages_, other.stages_);
    std::swap(bindings_, other.bindings_);
}

}  // namespace isorast::gpu
