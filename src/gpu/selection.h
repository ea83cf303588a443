// SPDX-License-Identifier: MIT
// What physical devices can do, and which one to take.
#pragma once
#include <optional>
#include <vector>

#include "gpu/device.h"

namespace isorast::gpu {

std::vector<VkQueueFamilyProperties> queue_families(VkPhysicalDevice physical);

// The queue family with graphics and compute, or compute alone; nothing without compute.
struct QueueChoice {
    uint32_t family = 0, timestamp_bits = 0;
    bool graphics = false;
};
std::optional<QueueChoice> choose_queue(VkPhysicalDevice physical);
// A family for copies alone, a DMA engine beside the cores, that can copy any slices of a 3D image;
// nothing where there is none.
std::optional<uint32_t> choose_copy_family(VkPhysicalDevice physical);

bool has_extension(VkPhysicalDevice physical, const char* name);
// Why the rasterizers that use graphics cannot run; empty if they can.
std::string why_not_hardware(bool graphics_queue, const Features& features);
Features supported_features(VkPhysicalDevice physical);
DeviceInfo describe(VkPhysicalDevice physical);
std::vector<VkPhysicalDevice> enumerate(VkInstance instance);
// Follows GpuOptions::device. Throws Error that lists the devices when none fits.
VkPhysicalDevice select(VkInstance instance, const std::string& wanted);

}  // namespace isorast::gpu
