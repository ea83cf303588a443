// SPDX-License-Identifier: MIT
// Medians and 95th percentiles of frames and of their passes; how much two pictures differ.
#include "statistics.h"

#include <algorithm>
#include <cmath>

namespace isorast::bench {

namespace {

Json quantiles(const std::vector<double>& values) {
    return {{"median_ms", quantile(values, 0.5)}, {"p95_ms", quantile(values, 0.95)}};
}

}  // namespace

double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    std::ranges::sort(values);
    const double at = share * double(values.size() - 1);
    const size_t below = size_t(at), above = std::min(below + 1, values.size() - 1);
    return std::lerp(values[below], values[above], at - double(below));
}

double frame_ms(const std::vector<gpu::TimedPass>& frame) {
    return frame.empty() ? 0 : frame.back().end_ms;
}

Json summarize(const std::vector<std::vector<gpu::TimedPass>>& frames) {
    Json passes = Json::object();
    std::vector<double> totals;
    std::vector<std::pair<std::string, std::vector<double>>> sums;  // in the order of the frame
    for (size_t i = 0; i < frames.size(); ++i) {
        totals.push_back(frame_ms(frames[i]));
        for (const gpu::TimedPass& pass : frames[i]) {
            auto known =
                std::ranges::find(sums, pass.name, [](const auto& sum) { return sum.first; });
            if (known == sums.end())
                known = sums.insert(known, {pass.name, std::vector<double>(frames.size())});
            known->second[i] += pass.end_ms - pass.begin_ms;
        }
    }
    for (const auto& [name, values] : sums)
        passes[name] = quantiles(values);
    Json frame = quantiles(totals);
    frame["frames"] = frames.size();
    return {{"frame", frame}, {"passes", passes}};
}

Difference difference(const Image& a, const Image& b, double voxel) {
    uint64_t both = 0, either = 0;
    double sum = 0;
    for (size_t i = 0; i < a.depth.size(); ++i) {
        const bool in_a = std::isfinite(a.depth[i]), in_b = std::isfinite(b.depth[i]);
        either += in_a || in_b;
        if (!in_a || !in_b) continue;
        ++both;
        sum += std::abs(double(a.depth[i]) - double(b.depth[i]));
    }
    if (either == 0) return {};
    return {double(both) / double(either), both ? sum / double(both) / voxel : 0};
}

}  // namespace isorast::bench
