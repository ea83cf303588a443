// SPDX-License-Identifier: MIT
// The gate works: planted bugs are reported by the validation layer. (It does not see hazards
// around mesh draws; isorast's only barrier is a full one between any two passes, see
// gpu::Commands::barrier.)
#include <gtest/gtest.h>
#include <isorast/renderer.h>

#include "gpu/commands.h"
#include "gpu/device.h"

namespace {

using namespace isorast;

bool mentions(const std::vector<std::string>& messages, const std::string& word) {
    for (const std::string& message : messages)
        if (message.find(word) != std::string::npos) return true;
    return false;
}

TEST(Validation, APlantedMisuseIsReported) {
    Gpu gpu({.validation = true});
    const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = 0};
    VkBuffer buffer = VK_NULL_HANDLE;
    vkCreateBuffer(gpu.device().handle(), &info, nullptr, &buffer);
    vkDestroyBuffer(gpu.device().handle(), buffer, nullptr);
    EXPECT_TRUE(mentions(gpu.validation_messages(), "VUID-VkBufferCreateInfo-size"));
}

// Fills a buffer and copies it, with or without the barrier that this needs.
std::vector<std::string> fill_and_copy(bool with_barrier) {
    Gpu gpu({.validation = true});
    const gpu::Device& device = gpu.device();
    const gpu::Buffer a(device, 64, gpu::Buffer::Memory::device, "a test");
    const gpu::Buffer b(device, 64, gpu::Buffer::Memory::device, "a test");
    gpu::run_once(device, [&](gpu::Commands& commands) {
        commands.fill(a, 1);
        if (with_barrier) commands.barrier();
        commands.copy(a, 0, b, 0, 64);
    });
    return gpu.validation_messages();
}

TEST(Validation, AMissingBarrierIsReported) {
    EXPECT_TRUE(mentions(fill_and_copy(/* with_barrier= */ false), "SYNC-HAZARD"));
    EXPECT_TRUE(fill_and_copy(/* with_barrier= */ true).empty());
}

TEST(Validation, IsOffUnlessAskedFor) {
    Gpu gpu;
    EXPECT_TRUE(gpu.validation_messages().empty());
}

}  // namespace
