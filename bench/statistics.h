// SPDX-License-Identifier: MIT
// Medians and 95th percentiles of frames and of their passes; how much two pictures differ.
#pragma once
#include "gpu/commands.h"
#include "settings.h"

namespace isorast::bench {

// Between two values where the share falls between them: of an even count, the median is the mean
// of the middle two.
double quantile(std::vector<double> values, double share);

// From the first to the last timestamp.
double frame_ms(const std::vector<gpu::TimedPass>& frame);

// {"frame": {"median_ms", "p95_ms", "frames"}, "passes": {NAME: {"median_ms", "p95_ms"}, ...}}.
// Passes of one name are summed in each frame; those that some frames lack count as 0 there.
Json summarize(const std::vector<std::vector<gpu::TimedPass>>& frames);

struct Difference {
    double overlap = 1;       // of the silhouettes: intersection over union
    double depth_voxels = 0;  // mean absolute difference where both pictures have a surface
};
// Of two pictures with depth.
Difference difference(const Image& a, const Image& b, double voxel);

}  // namespace isorast::bench
