// SPDX-License-Identifier: MIT
// What physical devices can do, and which one to take.
#include "gpu/selection.h"

#include <fmt/format.h>
#include <isorast/error.h>

#include <algorithm>
#include <cctype>
#include <cstring>

#include "gpu/vulkan_check.h"

namespace isorast::gpu {

namespace {

const char* kind_of(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return "discrete GPU";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return "integrated GPU";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return "virtual GPU";
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return "CPU";
        default:
            return "other";
    }
}

int rank_of(const DeviceInfo& info) {
    int rank = info.kind == "discrete GPU"     ? 3
               : info.kind == "integrated GPU" ? 2
               : info.kind == "virtual GPU"    ? 1
                                               : 0;
    return 2 * rank + (info.why_not_hardware.empty() ? 1 : 0);
}

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(),
                           [](unsigned char c) { return char(std::tolower(c)); });
    return text;
}

bool matches(const DeviceInfo& info, size_t index, const std::string& wanted) {
    if (wanted.empty()) return true;
    if (std::ranges::all_of(wanted, [](unsigned char c) { return std::isdigit(c); }))
        return std::to_string(index) == wanted;
    if (lower(wanted) == "cpu") return info.kind == "CPU";
    return lower(info.name).find(lower(wanted)) != std::string::npos;
}

std::string list_of(const std::vector<DeviceInfo>& infos) {
    std::string text;
    for (size_t i = 0; i < infos.size(); ++i) {
        text += fmt::format("{}{} {}", i ? "; " : "", i, infos[i].name);
        if (!infos[i].why_not_compute.empty()) text += " (" + infos[i].why_not_compute + ")";
    }
    return text;
}

}  // namespace

std::vector<VkQueueFamilyProperties> queue_families(VkPhysicalDevice physical) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    return families;
}

std::optional<QueueChoice> choose_queue(VkPhysicalDevice physical) {
    const auto families = queue_families(physical);
    std::optional<QueueChoice> choice;
    for (uint32_t i = 0; i < families.size(); ++i) {
        const bool graphics = families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT;
        if (!(families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)) continue;
        if (!choice || (graphics && !choice->graphics))
            choice = QueueChoice{i, families[i].timestampValidBits, graphics};
    }
    return choice;
}

std::optional<uint32_t> choose_copy_family(VkPhysicalDevice physical) {
    const auto families = queue_families(physical);
    for (uint32_t i = 0; i < families.size(); ++i) {
        // Nothing else, video for one; and whole slices must be allowed.
        const VkQueueFlags others =
            families[i].queueFlags & ~(VK_QUEUE_SPARSE_BINDING_BIT | VK_QUEUE_PROTECTED_BIT);
        const auto [x, y, z] = families[i].minImageTransferGranularity;
        if (others == VK_QUEUE_TRANSFER_BIT && x == 1 && y == 1 && z == 1) return i;
    }
    return std::nullopt;
}

bool has_extension(VkPhysicalDevice physical, const char* name) {
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
    return std::ranges::any_of(extensions, [&](const auto& extension) {
        return !std::strcmp(extension.extensionName, name);
    });
}

std::string why_not_hardware(bool graphics_queue, const Features& features) {
    if (!graphics_queue) return "no graphics queue";
    if (!features.mesh_shaders) return "no mesh shaders (VK_EXT_mesh_shader)";
    if (!features.dynamic_rendering) return "no dynamic rendering (Vulkan 1.3)";
    return "";
}

Features supported_features(VkPhysicalDevice physical) {
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical, &properties);
    VkPhysicalDevice16BitStorageFeatures storage{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_16BIT_STORAGE_FEATURES};
    VkPhysicalDeviceDescriptorIndexingFeatures indexing{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DESCRIPTOR_INDEXING_FEATURES};
    VkPhysicalDeviceDynamicRenderingFeatures rendering{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DYNAMIC_RENDERING_FEATURES};
    VkPhysicalDeviceMeshShaderFeaturesEXT mesh{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_FEATURES_EXT};
    VkPhysicalDeviceMultiviewFeatures multiview{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MULTIVIEW_FEATURES, &mesh};
    VkPhysicalDeviceFeatures2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &storage};
    if (properties.apiVersion >= VK_API_VERSION_1_2) storage.pNext = &indexing;
    if (properties.apiVersion >= VK_API_VERSION_1_3) indexing.pNext = &rendering;
    const bool mesh_extension = has_extension(physical, VK_EXT_MESH_SHADER_EXTENSION_NAME);
    if (mesh_extension && indexing.pNext) rendering.pNext = &multiview;
    vkGetPhysicalDeviceFeatures2(physical, &all);
    VkPhysicalDeviceMeshShaderPropertiesEXT most{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MESH_SHADER_PROPERTIES_EXT};
    VkPhysicalDeviceProperties2 limits{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    if (mesh_extension) limits.pNext = &most;
    vkGetPhysicalDeviceProperties2(physical, &limits);
    return {.storage_16bit = storage.storageBuffer16BitAccess == VK_TRUE,
            .nonuniform_textures = indexing.shaderSampledImageArrayNonUniformIndexing == VK_TRUE,
            .mesh_shaders = mesh.taskShader && mesh.meshShader,
            .mesh_multiview = mesh.multiviewMeshShader && multiview.multiview &&
                              most.maxMeshMultiviewViewCount >= 2,
            .dynamic_rendering = rendering.dynamicRendering == VK_TRUE,
            .storage_without_format = all.features.shaderStorageImageWriteWithoutFormat &&
                                      all.features.shaderStorageImageExtendedFormats,
            .fragment_stores = all.features.fragmentStoresAndAtomics == VK_TRUE,
            // The extension has this one feature.
            .representative_test =
                has_extension(physical, VK_NV_REPRESENTATIVE_FRAGMENT_TEST_EXTENSION_NAME)};
}

DeviceInfo describe(VkPhysicalDevice physical) {
    VkPhysicalDeviceProperties basic;
    vkGetPhysicalDeviceProperties(physical, &basic);
    DeviceInfo info{.name = basic.deviceName,
                    .kind = kind_of(basic.deviceType),
                    .max_image_side = basic.limits.maxImageDimension3D};
    info.api_version =
        fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(basic.apiVersion),
                    VK_API_VERSION_MINOR(basic.apiVersion), VK_API_VERSION_PATCH(basic.apiVersion));
    if (basic.apiVersion < VK_API_VERSION_1_1) {
        info.why_not_compute = info.why_not_hardware = "Vulkan " + info.api_version + ", needs 1.1";
        return info;
    }
    VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceMaintenance3Properties limits{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES};
    VkPhysicalDeviceSubgroupProperties subgroup{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES, &limits};
    if (basic.apiVersion >= VK_API_VERSION_1_2) limits.pNext = &driver;
    VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &subgroup};
    vkGetPhysicalDeviceProperties2(physical, &all);
    info.driver = fmt::format("{} {}", driver.driverName, driver.driverInfo);
    info.subgroup_size = subgroup.subgroupSize;
    const VkSubgroupFeatureFlags sums = VK_SUBGROUP_FEATURE_BASIC_BIT |
                                        VK_SUBGROUP_FEATURE_BALLOT_BIT |
                                        VK_SUBGROUP_FEATURE_ARITHMETIC_BIT;
    const VkShaderStageFlags mesh_stages =
        VK_SHADER_STAGE_TASK_BIT_EXT | VK_SHADER_STAGE_MESH_BIT_EXT;
    const bool can_sum = (subgroup.supportedOperations & sums) == sums;
    info.subgroup_sums = can_sum && (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT);
    info.mesh_subgroup_sums = can_sum && subgroup.subgroupSize >= 32 &&
                              (subgroup.supportedStages & mesh_stages) == mesh_stages;
    info.max_allocation_bytes = limits.maxMemoryAllocationSize;
    VkPhysicalDeviceMemoryProperties memory;
    vkGetPhysicalDeviceMemoryProperties(physical, &memory);
    for (uint32_t i = 0; i < memory.memoryHeapCount; ++i)
        if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
            info.memory_bytes = std::max<uint64_t>(info.memory_bytes, memory.memoryHeaps[i].size);

    const Features features = supported_features(physical);
    const auto queue = choose_queue(physical);
    if (!queue)
        info.why_not_compute = "no compute queue";
    else if (!features.storage_16bit)
        info.why_not_compute = "no 16-bit storage buffers";
    else if (basic.limits.maxPerStageDescriptorSampledImages < 80)
        info.why_not_compute = "fewer than 80 textures in a shader";
    info.why_not_hardware = info.why_not_compute.empty()
                                ? why_not_hardware(queue->graphics, features)
                                : info.why_not_compute;
    return info;
}

std::vector<VkPhysicalDevice> enumerate(VkInstance instance) {
    uint32_t count = 0;
    VK_CHECK(vkEnumeratePhysicalDevices(instance, &count, nullptr));
    std::vector<VkPhysicalDevice> devices(count);
    if (count) VK_CHECK(vkEnumeratePhysicalDevices(instance, &count, devices.data()));
    return devices;
}

VkPhysicalDevice select(VkInstance instance, const std::string& wanted) {
    const auto devices = enumerate(instance);
    if (devices.empty())
        throw Error(
            "Vulkan: no device found; install a driver, e.g. the package mesa-vulkan-drivers "
            "(its lavapipe runs on any CPU)");
    std::vector<DeviceInfo> infos;
    for (VkPhysicalDevice device : devices)
        infos.push_back(describe(device));
    int best = -1;
    for (size_t i = 0; i < infos.size(); ++i) {
        if (!matches(infos[i], i, wanted)) continue;
        if (!infos[i].why_not_compute.empty()) continue;
        if (best < 0 || rank_of(infos[i]) > rank_of(infos[best])) best = int(i);
    }
    if (best < 0)
        throw Error(fmt::format("{}: none fits; found {}",
                                wanted.empty() ? "Vulkan devices" : "device '" + wanted + "'",
                                list_of(infos)));
    return devices[best];
}

}  // namespace isorast::gpu
