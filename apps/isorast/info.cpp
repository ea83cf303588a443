// SPDX-License-Identifier: MIT
// isorast info: what a volume holds, and which isovalue to begin with.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "frames.h"
#include "histogram.h"
#include "options.h"

namespace isorast::cli {
namespace {

// Where each voxel axis points to, a letter each: "RAS", "LPI", ... The strongest component is
// named first, so that each side of the patient occurs once. Empty while the space is unknown.
std::string orientation(const Volume& volume) {
    if (volume.space == Space::unknown) return "";
    const auto spacing = volume.affine.spacing();
    const auto direction = [&](int row, int column) {
        return volume.affine.m[row][column] / (spacing[column] > 0 ? spacing[column] : 1);
    };
    std::string code = "???";
    std::array<bool, 3> named{};
    for (int turn = 0; turn < 3; ++turn) {
        int best_row = -1, best_column = -1;
        for (int column = 0; column < 3; ++column) {
            for (int row = 0; row < 3; ++row) {
                if (named[row] || code[column] != '?') continue;
                if (best_row < 0 ||
                    std::abs(direction(row, column)) > std::abs(direction(best_row, best_column))) {
                    best_row = row;
                    best_column = column;
                }
            }
        }
        code[best_column] = (direction(best_row, best_column) > 0 ? "RAS" : "LPI")[best_row];
        named[best_row] = true;
    }
    return code;
}

// True where each voxel axis runs along one world axis.
bool axis_aligned(const Affine& affine) {
    const auto spacing = affine.spacing();
    for (int column = 0; column < 3; ++column) {
        double largest = 0;
        for (int row = 0; row < 3; ++row)
            largest = std::max(largest, std::abs(affine.m[row][column]));
        if (largest < spacing[column] * (1 - 1e-6)) return false;
    }
    return true;
}

std::string with_units(const std::string& units) {
    return units.empty() ? "" : " " + units;
}

void line(const char* label, const std::string& text) {
    print(fmt::format("  {:<12} {}\n", label, text));
}

struct Info : Command {
    VolumeArguments arguments;
    bool json = false;

    explicit Info(CLI::App& parent)
        : Command(*parent.add_subcommand("info", "Say what a volume holds")) {
        arguments.add_to(app);
        app.add_flag("--json", json, "Print JSON");
        app.footer(
            "Example: isorast info head.nrrd\n"
            "         isorast info run/ --time 12\n"
            "         isorast info brick.raw --dims 256x256x128 --type u16");
    }

    std::string render_command(double isovalue) const {
        std::string line = "isorast render";
        for (const std::string& input : arguments.inputs)
            line += " " + shell_word(input);
        return fmt::format("{}{} --iso {:.6g}", line, arguments.as_typed, isovalue);
    }

    int run() override {
        const Series series = open_series(arguments.inputs, arguments.load);
        const auto steps = parse_steps(series, arguments.time, /* all= */ false);
        if (steps.size() > 1)
            throw CLI::ValidationError("--time", "info shows one time step, found several");
        Volume volume = series.load(steps.front());
        const bool mapped = volume.bytes.mapped();
        sample(volume);
        const Statistics values = statistics(volume);
        const double isovalue = suggest_isovalue(volume, values);
        if (json) {
            print(text_of(describe(volume, values, isovalue, mapped)));
        } else {
            print_header(volume, mapped);
            print_values(volume, values, isovalue);
        }
        return 0;
    }

    static Json describe(const Volume& volume, const Statistics& values, double isovalue,
                         bool mapped) {
        Json described{{"name", volume.name},
                       {"dims", volume.dims},
                       {"type", name_of(volume.type)},
                       {"bytes", volume.byte_count()},
                       {"mapped", mapped},
                       {"procedural", volume.field.has_value()},
                       {"spacing", volume.affine.spacing()},
                       {"affine", volume.affine.m},
                       {"space", volume.space == Space::ras ? "RAS" : "unknown"},
                       {"orientation", orientation(volume)},
                       {"length_units", volume.length_units},
                       {"value_units", volume.value_units},
                       {"slope", volume.slope},
                       {"intercept", volume.intercept},
                       {"time_steps", volume.time_steps},
                       {"time_step", volume.time_step},
                       {"not_finite", values.not_finite}};
        if (values.finite == 0) return described;
        if (values.no_data)
            described.update(
                Json{{"no_data", *values.no_data}, {"without_data", values.without_data}});
        described.update(Json{{"minimum", values.minimum},
                              {"maximum", values.maximum},
                              {"mean", values.mean},
                              {"standard_deviation", values.standard_deviation},
                              {"suggested_isovalue", isovalue},
                              {"histogram", values.histogram}});
        return described;
    }

    static void print_header(const Volume& volume, bool mapped) {
        const auto spacing = volume.affine.spacing();
        const auto& n = volume.dims;
        const char* how = volume.field ? "from a formula" : mapped ? "memory-mapped" : "in memory";
        print(volume.name + "\n");
        line("dimensions", fmt::format("{} x {} x {}", n[0], n[1], n[2]));
        line("type", fmt::format("{}, {}, {}", name_of(volume.type),
                                 human_bytes(volume.byte_count()), how));
        line("spacing", fmt::format("{:.6g} x {:.6g} x {:.6g}{}", spacing[0], spacing[1],
                                    spacing[2], with_units(volume.length_units)));
        line("extent",
             fmt::format("{:.6g} x {:.6g} x {:.6g}{}", n[0] * spacing[0], n[1] * spacing[1],
                         n[2] * spacing[2], with_units(volume.length_units)));
        const std::string code = orientation(volume);
        line("orientation",
             code.empty() ? "unknown" : code + (axis_aligned(volume.affine) ? "" : ", oblique"));
        for (int row = 0; row < 3; ++row) {
            const auto& m = volume.affine.m[row];
            line(row == 0 ? "affine" : "",
                 fmt::format("{:11.6g} {:11.6g} {:11.6g} {:11.6g}", m[0] + 0., m[1] + 0., m[2] + 0.,
                             m[3] + 0.));  // -0 + 0 is 0
        }
        if (volume.time_steps > 1) {
            line("time steps", fmt::format("{}, this is {} of 0 to {}", volume.time_steps,
                                           volume.time_step, volume.time_steps - 1));
        }
    }

    void print_values(const Volume& volume, const Statistics& values, double isovalue) const {
        if (values.not_finite > 0) {
            line("not finite", fmt::format("{} of {} voxels: these are outside of every surface",
                                           values.not_finite, volume.voxel_count()));
        }
        if (values.finite == 0) return line("values", "none that is finite");
        if (values.no_data)
            line("no data", fmt::format("{:.6g}, {} of {} voxels: left out below", *values.no_data,
                                        values.without_data, volume.voxel_count()));
        line("values", fmt::format("{:.6g} to {:.6g}{}", values.minimum, values.maximum,
                                   with_units(volume.value_units)));
        line("mean, sd", fmt::format("{:.6g}, {:.6g}", values.mean, values.standard_deviation));
        if (volume.slope != 1 || volume.intercept != 0) {
            line("scaling",
                 fmt::format("value = voxel * {:.9g} + {:.9g}", volume.slope, volume.intercept));
        }
        if (values.minimum == values.maximum) return line("surface", "none: all voxels are equal");
        print(fmt::format("\n{}\n{}\n", draw_histogram(values, volume, isovalue, terminal_width()),
                          render_command(isovalue)));
    }
};

}  // namespace

std::unique_ptr<Command> make_info(CLI::App& parent) {
    return std::make_unique<Info>(parent);
}

}  // namespace isorast::cli
