// SPDX-License-Identifier: MIT
// Series: the steps of a volume that changes in time.
#pragma once
#include <isorast/volume.h>

#include <functional>

namespace isorast {

// Volumes that differ in nothing but their voxels.
struct Series {
    std::string name;  // for messages
    uint32_t steps = 1;
    // Makes step 0 to steps - 1. A Renderer calls it from a thread of its own too, one call at a
    // time, and takes an Error as that step's. A step that was made once may be asked for again.
    std::function<Volume(uint32_t step)> load;
};

// Volumes in memory; they must stay alive and unchanged for as long as the series is used. Throws
// Error for none.
Series series_of(std::span<const Volume> volumes);
// The time steps of a formula, "coral:64:steps=30": sampled where they are needed, on the GPU where
// it can. Through sample(), series_of() makes voxels of it that have to be uploaded. Throws Error
// as make_procedural() does.
Series procedural_series(std::string_view name);
// These steps of a series, in this order. Throws Error for none, and for one that it does not have.
Series chosen_steps(const Series& series, std::vector<uint32_t> steps);

// Throws Error, named after the step, unless it has the dimensions, the voxel type, the affine and
// the slope and intercept of the first.
void check_step(const Volume& step, const Volume& first);

}  // namespace isorast
