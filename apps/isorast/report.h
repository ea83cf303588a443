// SPDX-License-Identifier: MIT
// What `render` says about a frame: a line, a table of passes, or JSON.
#pragma once
#include "options.h"

namespace isorast::cli {

struct RenderReport {
    std::vector<std::string> outputs;  // pictures written: one, or more for time steps and layers
    std::vector<uint32_t> time_steps;
    Size size;
    std::vector<double> isovalues;
    std::string technique, rasterizer, culling, device, driver;
    std::array<double, 2> value_range{};
    double seconds = 0;  // from the start of the command to the written file
    FrameStats stats;    // the median of `frames`
    double longest_wait_ms = 0;
    size_t frames = 1;
    std::optional<Difference> difference;
    double tolerance = 0;
};

// The times as medians, of each pass over the frames that have it; the counts of the last frame.
FrameStats median_of(const std::vector<FrameStats>& frames);

// "head.png  1280x720  iso 300  direct, hardware rasterizer  llvmpipe  0.42 s"
std::string summary(const RenderReport& report);
std::string stats_table(const RenderReport& report);
Json json_of(const RenderReport& report);

}  // namespace isorast::cli
