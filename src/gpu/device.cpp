// SPDX-License-Identifier: MIT
// Creation and destruction of the Vulkan instance and device; device memory.
#include "gpu/device.h"

#include <fmt/format.h>
#include <isorast/embed.h>
#include <isorast/error.h>

#include <cstring>

#include "gpu/selection.h"
#include "gpu/vulkan_check.h"

namespace isorast::gpu {

const char* result_name(VkResult result) {
    switch (result) {
        case VK_ERROR_OUT_OF_HOST_MEMORY:
            return "out of host memory";
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
            return "out of device memory";
        case VK_ERROR_INITIALIZATION_FAILED:
            return "initialization failed";
        case VK_ERROR_DEVICE_LOST:
            return "device lost";
        case VK_ERROR_LAYER_NOT_PRESENT:
            return "layer not present";
        case VK_ERROR_EXTENSION_NOT_PRESENT:
            return "extension not present";
        case VK_ERROR_FEATURE_NOT_PRESENT:
            return "feature not present";
        case VK_ERROR_INCOMPATIBLE_DRIVER:
            return "no compatible driver";
        case VK_ERROR_FORMAT_NOT_SUPPORTED:
            return "format not supported";
        default:
            return "error";
    }
}

void throw_vulkan_error(const char* call, VkResult result) {
    const std::string function(call, std::strcspn(call, "("));
    throw Error(
        fmt::format("Vulkan: {} failed: {} ({})", function, result_name(result), int(result)));
}

namespace {

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data,
                                          void* device) {
    auto& self = *static_cast<Device*>(device);
    const std::lock_guard lock(self.messages_mutex);
    self.validation_messages.emplace_back(data->pMessage);
    return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(Device* device) {
    return {.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
            .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                               VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
            // Not the performance type: it advises against GENERAL layout, which we choose.
            .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
            .pfnUserCallback = on_message,
            .pUserData = device};
}

bool instance_has(const char* extension) {
    uint32_t count = 0;
    vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateInstanceExtensionProperties(nullptr, &count, extensions.data());
    for (const auto& found : extensions)
        if (!std::strcmp(found.extensionName, extension)) return true;
    return false;
}

VkInstance make_instance(const void* next, const std::vector<const char*>& layers,
                         const std::vector<const char*>& extensions) {
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .pApplicationName = "isorast",
                                        .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                    .pNext = next,
                                    .pApplicationInfo = &application,
                                    .enabledLayerCount = uint32_t(layers.size()),
                                    .ppEnabledLayerNames = layers.data(),
                                    .enabledExtensionCount = uint32_t(extensions.size()),
                                    .ppEnabledExtensionNames = extensions.data()};
    VkInstance instance = VK_NULL_HANDLE;
    const VkResult result = vkCreateInstance(&info, nullptr, &instance);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
        throw Error(
            "Vulkan: no driver found; install one, e.g. the package mesa-vulkan-drivers (its "
            "lavapipe runs on any CPU)");
    if (result == VK_ERROR_LAYER_NOT_PRESENT)
        throw Error(
            "validation: the layer VK_LAYER_KHRONOS_validation is not installed; install the "
            "package vulkan-validationlayers, or leave validation off");
    VK_CHECK(result);
    return instance;
}

}  // namespace

Device::Device(const GpuOptions& options) : Device() {
    create_instance(options.validation);
    physical_ = select(instance_, options.device);
    adopt_physical();
    create_device();
    load_functions();
}

Device::Device(const HostDevice& host)
    : instance_(host.instance),
      physical_(host.physical_device),
      device_(host.device),
      queue_(host.queue),
      owned_(false) {
    adopt_physical();
    queue_family_ = host.queue_family;
    upload_queue_ = host.upload_queue ? host.upload_queue : queue_;
    upload_family_ = host.upload_queue ? host.upload_queue_family : queue_family_;
    const auto families = queue_families(physical_);
    if (queue_family_ >= families.size() ||
        !(families[queue_family_].queueFlags & VK_QUEUE_COMPUTE_BIT))
        throw Error(fmt::format("HostDevice: expected a queue family with compute, found {} of {}",
                                queue_family_, families.size()));
    has_graphics_ = families[queue_family_].queueFlags & VK_QUEUE_GRAPHICS_BIT;
    timestamp_bits_ = families[queue_family_].timestampValidBits;
    if (!info_.why_not_compute.empty())
        throw Error(fmt::format("HostDevice: {} cannot run isorast: {}", info_.name,
                                info_.why_not_compute));
    if (!host.storage_16bit)
        throw Error("HostDevice: storageBuffer16BitAccess must be enabled on the adopted device");
    features_ = {.storage_16bit = true,
                 .nonuniform_textures = host.nonuniform_textures,
                 .mesh_shaders = host.mesh_shaders,
                 .mesh_multiview = host.mesh_multiview,
                 .dynamic_rendering = host.dynamic_rendering,
                 .storage_without_format = host.storage_without_format,
                 .fragment_stores = host.fragment_stores,
                 .representative_test = host.representative_test};
    const std::string missing = why_not_hardware(has_graphics_, features_);
    if (info_.why_not_hardware.empty() && !missing.empty())
        info_.why_not_hardware = missing + " on the host's device";
    load_functions();
}

Device::~Device() {
    if (!owned_) return;
    if (device_) vkDeviceWaitIdle(device_);
    vkDestroyDevice(device_, nullptr);
    if (messenger_) {
        auto destroy = PFN_vkDestroyDebugUtilsMessengerEXT(
            vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
        destroy(instance_, messenger_, nullptr);
    }
    vkDestroyInstance(instance_, nullptr);
}

void Device::create_instance(bool validation) {
    std::vector<const char*> layers, extensions;
    if (validation) layers.push_back("VK_LAYER_KHRONOS_validation");
    debug_utils_ = instance_has(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    if (debug_utils_) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    const VkValidationFeatureEnableEXT synchronization =
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    auto messenger = messenger_info(this);
    const VkValidationFeaturesEXT checks{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                         .pNext = &messenger,
                                         .enabledValidationFeatureCount = 1,
                                         .pEnabledValidationFeatures = &synchronization};
    instance_ = make_instance(validation ? &checks : nullptr, layers, extensions);
    if (!validation || !debug_utils_) return;
    auto create = PFN_vkCreateDebugUtilsMessengerEXT(
        vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
    VK_CHECK(create(instance_, &messenger, nullptr, &messenger_));
}

void Device::adopt_physical() {
    vkGetPhysicalDeviceProperties(physical_, &properties_);
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
    info_ = describe(physical_);
}

void Device::create_device() {
    const QueueChoice queue = choose_queue(physical_).value();
    queue_family_ = queue.family;
    upload_family_ = choose_copy_family(physical_).value_or(queue_family_);
    timestamp_bits_ = queue.timestamp_bits;
    has_graphics_ = queue.graphics;
    features_ = supported_features(physical_);
    features_.mesh_shaders = features_.mesh_shaders && info_.why_not_hardware.empty();
    features_.representative_test = features_.representative_test && features_.mesh_shaders;
    features_.mesh_multiview = features_.mesh_multiview && features_.mesh_shaders;

    // Chain only the structures that this device's version and extensions know.
    VkPhysicalDeviceRepresentativeFragmentTestFeaturesNV representative{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_REPRESENTATIVE_FRAGMENT_TEST_FEATURES_NV,
        .representativeFragmentTest = VK_TRUE};
    VkPhysicalDeviceMeshShaderFeaturesEXT mesh{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT,
        .pNext = features_.representative_test ? &representative : nullptr,
        .taskShader = VK_TRUE,
        .meshShader = VK_TRUE,
        .multiviewMeshShader = features_.mesh_multiview};
    VkPhysicalDeviceMultiviewFeatures multiview{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MULTIVIEW_FEATURES,
        .pNext = features_.mesh_shaders ? &mesh : nullptr,
        .multiview = features_.mesh_multiview};
    VkPhysicalDeviceDynamicRenderingFeatures rendering{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES,
        .pNext = &multiview,
        .dynamicRendering = features_.dynamic_rendering};
    VkPhysicalDeviceDescriptorIndexingFeatures indexing{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DESCRIPTOR_INDEXING_FEATURES,
        .pNext = properties_.apiVersion >= VK_API_VERSION_1_3 ? &rendering : nullptr,
        .shaderSampledImageArrayNonUniformIndexing = features_.nonuniform_textures};
    const VkPhysicalDevice16BitStorageFeatures storage{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_16BIT_STORAGE_FEATURES,
        .pNext = properties_.apiVersion >= VK_API_VERSION_1_2 ? &indexing : nullptr,
        .storageBuffer16BitAccess = VK_TRUE};
    const VkPhysicalDeviceFeatures core{
        .fragmentStoresAndAtomics = features_.fragment_stores,
        .shaderStorageImageExtendedFormats = features_.storage_without_format,
        .shaderStorageImageWriteWithoutFormat = features_.storage_without_format};
    const float priority = 1;
    std::vector<VkDeviceQueueCreateInfo> queues(upload_family_ == queue_family_ ? 1 : 2);
    for (size_t i = 0; i < queues.size(); ++i)
        queues[i] = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                     .queueFamilyIndex = i == 0 ? queue_family_ : upload_family_,
                     .queueCount = 1,
                     .pQueuePriorities = &priority};
    std::vector<const char*> extensions;
    if (features_.mesh_shaders) extensions.push_back(VK_EXT_MESH_SHADER_EXTENSION_NAME);
    if (features_.representative_test)
        extensions.push_back(VK_NV_REPRESENTATIVE_FRAGMENT_TEST_EXTENSION_NAME);
    if (has_extension(physical_, "VK_KHR_portability_subset"))
        extensions.push_back("VK_KHR_portability_subset");
    const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                  .pNext = &storage,
                                  .queueCreateInfoCount = uint32_t(queues.size()),
                                  .pQueueCreateInfos = queues.data(),
                                  .enabledExtensionCount = uint32_t(extensions.size()),
                                  .ppEnabledExtensionNames = extensions.data(),
                                  .pEnabledFeatures = &core};
    VK_CHECK(vkCreateDevice(physical_, &info, nullptr, &device_));
    vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
    vkGetDeviceQueue(device_, upload_family_, 0, &upload_queue_);
}

void Device::load_functions() {
    const auto load = [&](auto& function, const char* name) {
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(
            vkGetDeviceProcAddr(device_, name));
    };
    if (features_.mesh_shaders)
        load(functions_.draw_mesh_tasks_indirect, "vkCmdDrawMeshTasksIndirectEXT");
    if (features_.dynamic_rendering) {
        load(functions_.begin_rendering, "vkCmdBeginRendering");
        load(functions_.end_rendering, "vkCmdEndRendering");
    }
    if (debug_utils_) {
        load(functions_.set_name, "vkSetDebugUtilsObjectNameEXT");
        load(functions_.begin_label, "vkCmdBeginDebugUtilsLabelEXT");
        load(functions_.end_label, "vkCmdEndDebugUtilsLabelEXT");
    }
}

void Device::submit(VkQueue queue, const VkSubmitInfo& info, VkFence fence) const {
    const std::lock_guard lock(submit_mutex_);
    VK_CHECK(vkQueueSubmit(queue, 1, &info, fence));
}

VkDeviceMemory Device::allocate(const VkMemoryRequirements& requirements,
                                VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags preferred,
                                const char* what) const {
    for (const VkMemoryPropertyFlags flags : {wanted | preferred, wanted})
        for (uint32_t i = 0; i < memory_.memoryTypeCount; ++i) {
            if (!(requirements.memoryTypeBits & (1u << i))) continue;
            if ((memory_.memoryTypes[i].propertyFlags & flags) != flags) continue;
            const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                            .allocationSize = requirements.size,
                                            .memoryTypeIndex = i};
            VkDeviceMemory memory = VK_NULL_HANDLE;
            const VkResult result = vkAllocateMemory(device_, &info, nullptr, &memory);
            if (result == VK_SUCCESS) return memory;
            if (result != VK_ERROR_OUT_OF_DEVICE_MEMORY && result != VK_ERROR_OUT_OF_HOST_MEMORY)
                VK_CHECK(result);
        }
    throw Error(
        fmt::format("{}: cannot allocate {} bytes for {}; close other programs, or use a "
                    "smaller volume or picture",
                    info_.name, requirements.size, what));
}

std::vector<std::string> Device::messages() const {
    const std::lock_guard lock(messages_mutex);
    return validation_messages;
}

}  // namespace isorast::gpu

namespace isorast {

Gpu::Gpu(const GpuOptions& options) : device_(std::make_unique<gpu::Device>(options)) {}
Gpu::Gpu(const HostDevice& host) : device_(std::make_unique<gpu::Device>(host)) {}
Gpu::Gpu(Gpu&&) noexcept = default;
Gpu::~Gpu() = default;
const DeviceInfo& Gpu::info() const {
    return device_->info();
}
std::vector<std::string> Gpu::validation_messages() const {
    return device_->messages();
}

std::vector<DeviceInfo> list_devices() {
    const VkInstance instance = gpu::make_instance(nullptr, {}, {});
    std::vector<DeviceInfo> infos;
    const std::unique_ptr<VkInstance_T, void (*)(VkInstance)> owner(
        instance, [](VkInstance old) { vkDestroyInstance(old, nullptr); });
    for (VkPhysicalDevice device : gpu::enumerate(instance))
        infos.push_back(gpu::describe(device));
    return infos;
}

}  // namespace isorast
