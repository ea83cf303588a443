// SPDX-License-Identifier: MIT
// A Vulkan device, chosen or adopted. Includes no Vulkan header; <isorast/embed.h> does.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace isorast {

namespace gpu {
class Device;
}
struct HostDevice;  // <isorast/embed.h>

struct DeviceInfo {
    std::string name, driver, kind;  // kind: "discrete GPU", "integrated GPU", "CPU", ...
    std::string api_version;
    uint32_t subgroup_size = 0;
    bool subgroup_sums = false;       // compute shaders can add across a subgroup
    bool mesh_subgroup_sums = false;  // task and mesh shaders can, across 32 threads
    uint64_t memory_bytes = 0;        // of the largest device-local heap
    uint64_t max_allocation_bytes = 0;
    uint32_t max_image_side = 0;  // voxels along one side of a 3D image
    // Empty when the device can; else why it cannot, in a few words.
    std::string why_not_hardware, why_not_compute;
};

// Every device that the loader knows, in its order, those that do not fit too. Throws Error where
// there is no driver.
std::vector<DeviceInfo> list_devices();

enum class Rasterizer : uint8_t { automatic, hardware, compute };
// How occlusion culling finds hidden blocks: by raster proxies, as in the paper (needs the hardware
// rasterizer), or by a depth pyramid (HiZ). The picture is the same.
enum class Occlusion : uint8_t { automatic, raster, hiz };

// What `automatic` becomes for direct on a device; see choose_rasterizer() in <isorast/renderer.h>.
struct RasterizerChoice {
    Rasterizer rasterizer = Rasterizer::automatic;  // still automatic: neither works
    // The fastest frame of a small scene, milliseconds; 0: not measured, as there was no choice.
    double hardware_ms = 0, compute_ms = 0;
    // With the hardware rasterizer: HiZ, unless proxies are faster by a tenth.
    Occlusion occlusion = Occlusion::hiz;
    std::string problem;  // why the compute rasterizer is not to be trusted here; empty: it is
};

struct GpuOptions {
    // "" picks the best one: discrete, integrated, virtual, CPU; those with mesh shaders first.
    // Else a number from list_devices(), a part of a name, or "cpu".
    std::string device;
    bool validation = false;  // the Khronos layer; every message is kept in validation_messages()
};

class Gpu {
public:
    // Throws Error where there is no driver, when no device fits, with the reason for each, and
    // when the validation layer is wanted but not installed.
    explicit Gpu(const GpuOptions& options = {});
    // Adopts the host's instance, device and queue, which must outlive this object. Throws Error
    // without HostDevice::storage_16bit, for a queue family without compute, and for a device with
    // a why_not_compute.
    explicit Gpu(const HostDevice& host);
    Gpu(Gpu&&) noexcept;
    ~Gpu();

    const DeviceInfo& info() const;
    // Warnings and errors that the validation layer has reported so far; empty when it is off.
    std::vector<std::string> validation_messages() const;

    gpu::Device& device() const { return *device_; }

private:
    std::unique_ptr<gpu::Device> device_;
};

}  // namespace isorast
