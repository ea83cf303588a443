// SPDX-License-Identifier: MIT
// VK_CHECK: every Vulkan result is looked at; a failure becomes an Error that names the call and
// the result.
#pragma once
#include <vulkan/vulkan.h>

namespace isorast::gpu {

const char* result_name(VkResult result);
[[noreturn]] void throw_vulkan_error(const char* call, VkResult result);

}  // namespace isorast::gpu

#define VK_CHECK(call)                                                  \
    do {                                                                \
        const VkResult vk_check_result = (call);                        \
        if (vk_check_result != VK_SUCCESS)                              \
            ::isorast::gpu::throw_vulkan_error(#call, vk_check_result); \
    } while (false)
