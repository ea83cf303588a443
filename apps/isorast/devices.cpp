// SPDX-License-Identifier: MIT
// isorast devices: what Vulkan finds here, and what each device can do.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "options.h"

namespace isorast::cli {
namespace {

using Row = std::array<std::string, 9>;

std::string yes_or(const std::string& why_not) {
    return why_not.empty() ? "yes" : "no: " + why_not;
}

void print_table(const std::vector<Row>& rows) {
    std::array<size_t, std::tuple_size_v<Row>> widths{};
    for (const Row& row : rows) {
        for (size_t i = 0; i < row.size(); ++i)
            widths[i] = std::max(widths[i], row[i].size());
    }
    for (const Row& row : rows) {
        std::string line;
        for (size_t i = 0; i < row.size(); ++i)
            line += fmt::format("{:<{}}  ", row[i], widths[i]);
        line.erase(line.find_last_not_of(' ') + 1);
        print(line + "\n");
    }
}

// Which rasterizer direct takes there, and why.
std::string describe(const RasterizerChoice& choice) {
    std::string text(choice.rasterizer == Rasterizer::automatic ? "none"
                                                                : name_of(choice.rasterizer));
    if (!choice.problem.empty())
        return text + fmt::format(" (compute fails its self-test: {})", choice.problem);
    if (choice.hardware_ms > 0)
        text +=
            fmt::format(" (a small scene: hardware {:.2f} ms with {} culling, compute {:.2f} ms)",
                        choice.hardware_ms, name_of(choice.occlusion), choice.compute_ms);
    return text;
}

// Asks a device that can compute; the first time, that takes a moment.
RasterizerChoice choose(const DeviceInfo& info, size_t number) {
    if (!info.why_not_compute.empty()) return {.problem = info.why_not_compute};
    Gpu gpu({.device = std::to_string(number)});
    return choose_rasterizer(gpu);
}

Json describe(const DeviceInfo& info, size_t number) {
    const RasterizerChoice choice = choose(info, number);
    return {{"number", number},
            {"name", info.name},
            {"kind", info.kind},
            {"driver", info.driver},
            {"api_version", info.api_version},
            {"subgroup_size", info.subgroup_size},
            {"memory_bytes", info.memory_bytes},
            {"max_allocation_bytes", info.max_allocation_bytes},
            {"max_image_side", info.max_image_side},
            {"hardware", info.why_not_hardware.empty()},
            {"why_not_hardware", info.why_not_hardware},
            {"compute", info.why_not_compute.empty()},
            {"why_not_compute", info.why_not_compute},
            {"rasterizer", name_of(choice.rasterizer)},
            {"compute_problem", choice.problem},
            {"hardware_ms", choice.hardware_ms},
            {"hardware_culling", name_of(choice.occlusion)},
            {"compute_ms", choice.compute_ms}};
}

struct Devices : Command {
    bool json = false;

    explicit Devices(CLI::App& parent)
        : Command(*parent.add_subcommand("devices", "List the devices and what each can do")) {
        app.add_flag("--json", json, "Print JSON");
        app.footer(
            "Example: isorast devices\n"
            "Then: isorast render sphere:64 --device 1, or a part of a name, or cpu");
    }

    int run() override {
        const std::vector<DeviceInfo> devices = list_devices();
        if (json) {
            Json list = Json::array();
            for (size_t i = 0; i < devices.size(); ++i)
                list.push_back(describe(devices[i], i));
            print(text_of(list));
            return 0;
        }
        if (devices.empty()) {
            throw Error("no Vulkan device found; install a driver, for a CPU mesa-vulkan-drivers");
        }
        std::vector<Row> rows{{"#", "name", "kind", "driver", "Vulkan", "memory", "compute",
                               "hardware rasterizer", "direct takes"}};
        for (size_t i = 0; i < devices.size(); ++i) {
            const DeviceInfo& info = devices[i];
            rows.push_back({std::to_string(i), info.name, info.kind, info.driver, info.api_version,
                            human_bytes(info.memory_bytes), yes_or(info.why_not_compute),
                            yes_or(info.why_not_hardware), describe(choose(info, i))});
        }
        print_table(rows);
        return 0;
    }
};

}  // namespace

std::unique_ptr<Command> make_devices(CLI::App& parent) {
    return std::make_unique<Devices>(parent);
}

}  // namespace isorast::cli
