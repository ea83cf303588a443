// SPDX-License-Identifier: MIT
// Series of volumes, and what their steps must have in common.
#include <isorast/series.h>

#include <cmath>

#include "volume/text.h"
#include "volume/voxels.h"

namespace isorast {

namespace {

std::string dims_of(const Volume& volume) {
    return fmt::format("{}", fmt::join(volume.dims, "x"));
}

// Header numbers that went through single precision are still the same.
bool close(double a, double b, double scale) {
    return std::abs(a - b) <= 1e-5 * scale;
}

bool same_place(const Volume& a, const Volume& b) {
    if (a.space != b.space) return false;
    const auto spacing = a.affine.spacing();
    double extent = 0;
    for (int axis = 0; axis < 3; ++axis)
        extent = std::max(extent, spacing[axis] * a.dims[axis]);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            if (!close(a.affine.m[row][column], b.affine.m[row][column],
                       column < 3 ? spacing[column] : extent))
                return false;
    return true;
}

std::string rows_of(const Affine& affine) {
    std::string text;
    for (const auto& row : affine.m)
        text += fmt::format("({:.6g})", fmt::join(row, " "));
    return text;
}

}  // namespace

Volume header_of(const Volume& volume) {
    return {.name = volume.name,
            .dims = volume.dims,
            .type = volume.type,
            .bytes = {},
            .field = volume.field,
            .affine = volume.affine,
            .space = volume.space,
            .length_units = volume.length_units,
            .slope = volume.slope,
            .intercept = volume.intercept,
            .value_units = volume.value_units,
            .time_steps = volume.time_steps,
            .time_step = volume.time_step};
}

Series series_of(std::span<const Volume> volumes) {
    if (volumes.empty()) throw Error("series: expected at least one volume, found none");
    return {.name = volumes.front().name,
            .steps = static_cast<uint32_t>(volumes.size()),
            .load = [volumes](uint32_t step) {
                Volume volume = header_of(volumes[step]);
                volume.bytes = VoxelBytes::borrow(volumes[step].bytes.span());
                return volume;
            }};
}

Series procedural_series(std::string_view name) {
    return {
        .name = std::string(name),
        .steps = make_procedural(name).time_steps,
        .load = [name = std::string(name)](uint32_t step) { return make_procedural(name, step); }};
}

Series chosen_steps(const Series& series, std::vector<uint32_t> steps) {
    if (steps.empty()) fail(series.name, "expected at least one time step, found none");
    for (const uint32_t step : steps)
        if (step >= series.steps)
            fail(series.name, "expected time steps from 0 to {}, found {}", series.steps - 1, step);
    const auto count = static_cast<uint32_t>(steps.size());
    return {.name = series.name,
            .steps = count,
            .load = [load = series.load, steps = std::move(steps)](uint32_t step) {
                return load(steps[step]);
            }};
}

void check_step(const Volume& step, const Volume& first) {
    const auto differs = [&](std::string_view what, const std::string& expected,
                             const std::string& found) {
        fail(step.name,
             "expected the {} of {}, {}, found {}; the steps of a series may differ in nothing but "
             "their voxels",
             what, first.name, expected, found);
    };
    if (step.dims != first.dims) differs("dimensions", dims_of(first), dims_of(step));
    if (step.type != first.type)
        differs("type", std::string(name_of(first.type)), std::string(name_of(step.type)));
    if (step.slope != first.slope || step.intercept != first.intercept)
        differs("scaling", fmt::format("voxel * {:.9g} + {:.9g}", first.slope, first.intercept),
                fmt::format("voxel * {:.9g} + {:.9g}", step.slope, step.intercept));
    if (!same_place(step, first)) differs("affine", rows_of(first.affine), rows_of(step.affine));
}

}  // namespace isorast
