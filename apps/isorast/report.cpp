// SPDX-License-Identifier: MIT
// What `render` says about a frame; see report.h.
#include "report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace isorast::cli {
namespace {

double median(std::vector<double> values) {
    const size_t middle = values.size() / 2;
    std::ranges::sort(values);
    return values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

}  // namespace

FrameStats median_of(const std::vector<FrameStats>& frames) {
    FrameStats result = frames.back();
    std::vector<double> totals, waits;
    std::map<std::string, std::vector<double>> passes;
    for (const FrameStats& frame : frames) {
        totals.push_back(frame.total_ms);
        waits.push_back(frame.wait_ms);
        for (const PassTime& pass : frame.passes)
            passes[pass.name].push_back(pass.milliseconds);
    }
    result.total_ms = median(std::move(totals));
    result.wait_ms = median(std::move(waits));
    // In the order of the frame with the most passes: some have one that others do not need.
    result.passes = std::ranges::max(frames, {}, [](const FrameStats& frame) {
                        return frame.passes.size();
                    }).passes;
    for (PassTime& pass : result.passes)
        pass.milliseconds = median(passes[pass.name]);
    return result;
}

std::string summary(const RenderReport& report) {
    std::string isovalues;
    for (double isovalue : report.isovalues) {
        isovalues += fmt::format("{}{:.6g}", isovalues.empty() ? "" : ", ", isovalue);
    }
    const std::vector<std::string>& names = report.outputs;
    const std::string output =
        names.size() == 1
            ? names.front()
            : fmt::format("{} pictures, {} to {}", names.size(), names.front(), names.back());
    return fmt::format("{}  {}x{}  iso {}  {}, {} rasterizer  {}  {:.2f} s\n", output,
                       report.size.width, report.size.height, isovalues, report.technique,
                       report.rasterizer, report.device, report.seconds);
}

std::string stats_table(const RenderReport& report) {
    const FrameStats& stats = report.stats;
    std::string text =
        fmt::format("GPU time{}\n",
                    report.frames > 1 ? fmt::format(", median of {} frames", report.frames) : "");
    for (const PassTime& pass : stats.passes) {
        text += fmt::format("  {:<24}{:>10.3f} ms\n", pass.name, pass.milliseconds);
    }
    text += fmt::format("  {:<24}{:>10.3f} ms\n", "total", stats.total_ms);
    text += fmt::format("blocks {}  active {}  drawn {}  (culling: {})\n", stats.blocks,
                        stats.blocks_active, stats.blocks_drawn, report.culling);
    if (report.time_steps.size() > 1)
        text += fmt::format(
            "time steps {}  on the GPU {}  waited for {:.3f} ms (median), {:.3f} ms (longest)\n",
            report.time_steps.size(), stats.resident_steps, stats.wait_ms, report.longest_wait_ms);
    const double share = stats.volume_bytes == 0 ? 0
                                                 : 100.0 * static_cast<double>(stats.extra_bytes) /
                                                       static_cast<double>(stats.volume_bytes);
    text += fmt::format(
        "GPU memory: volume {} in {} brick{}, frame targets {}, all else {} ({:.2g} % of the "
        "volume)\n",
        human_bytes(stats.volume_bytes), stats.bricks, stats.bricks == 1 ? "" : "s",
        human_bytes(stats.target_bytes), human_bytes(stats.extra_bytes), share);
    return text;
}

Json json_of(const RenderReport& report) {
    const FrameStats& stats = report.stats;
    Json passes = Json::array();
    for (const PassTime& pass : stats.passes) {
        passes.push_back({{"name", pass.name}, {"milliseconds", pass.milliseconds}});
    }
    Json json{{"output", report.outputs.front()},
              {"size", {report.size.width, report.size.height}},
              {"isovalues", report.isovalues},
              {"value_range", report.value_range},
              {"technique", report.technique},
              {"rasterizer", report.rasterizer},
              {"culling", report.culling},
              {"device", report.device},
              {"driver", report.driver},
              {"seconds", report.seconds},
              {"frames", report.frames},
              {"passes", passes},
              {"total_ms", stats.total_ms},
              {"blocks", stats.blocks},
              {"blocks_active", stats.blocks_active},
              {"blocks_drawn", stats.blocks_drawn},
              {"bricks", stats.bricks},
              {"volume_bytes", stats.volume_bytes},
              {"extra_bytes", stats.extra_bytes},
              {"target_bytes", stats.target_bytes}};
    if (report.outputs.size() > 1) json["outputs"] = report.outputs;
    if (report.time_steps.size() > 1)
        json.update(Json{{"time_steps", report.time_steps},
                         {"resident_steps", stats.resident_steps},
                         {"wait_ms", stats.wait_ms},
                         {"longest_wait_ms", report.longest_wait_ms}});
    if (report.difference) {
        json["difference"] = cli::json_of(*report.difference, report.tolerance);
    }
    return json;
}

}  // namespace isorast::cli
