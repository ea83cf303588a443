// SPDX-License-Identifier: MIT
// Which axes of a NRRD file are space and which is time, and where in the world the voxels lie.
#include <algorithm>

#include "volume/formats/data.h"
#include "volume/formats/nrrd.h"
#include "volume/formats/units.h"

namespace isorast {
namespace {

struct Axis {
    uint64_t size = 0;
    std::string kind;
    std::optional<std::vector<double>> direction;  // empty for an axis that is not in space
    double spacing = 1, minimum = NAN, maximum = NAN;
    bool cell_centered = true;
};

// One word for each axis, or nothing when the field is absent.
std::vector<std::string_view> per_axis(const NrrdHeader& header, const std::string& field,
                                       size_t count) {
    const auto text = header.optional(field);
    if (!text) return {};
    const auto words = split(*text);
    if (words.size() != count)
        fail(header.path, "{}: expected {} words, one for each axis, found {}", field, count,
             words.size());
    return words;
}

double number(const NrrdHeader& header, const std::string& field, std::string_view word) {
    const auto value = parse_number<double>(trimmed(word));
    if (!value) fail(header.path, "{}: expected a number, found {}", field, quoted(word));
    return *value;
}

// "(1,0,0) (0, 1, 0) none": a vector or nothing for each axis.
std::vector<std::optional<std::vector<double>>> vectors(const NrrdHeader& header,
                                                        const std::string& field) {
    std::vector<std::optional<std::vector<double>>> result;
    std::string_view text = header.required(field);
    while (!(text = trimmed(text)).empty()) {
        if (lowercase(text.substr(0, 4)) == "none") {
            result.emplace_back();
            text.remove_prefix(4);
            continue;
        }
        const size_t end = text.find(')');
        if (text[0] != '(' || end == std::string_view::npos)
            fail(header.path, "{}: expected vectors like (1,0,0), or none, found {}", field,
                 quoted(text));
        std::vector<double> vector;
        for (const std::string_view word : split(text.substr(1, end - 1), ", \t"))
            vector.push_back(number(header, field, word));
        // Vectors of NaN say the same as "none".
        const bool known =
            std::none_of(vector.begin(), vector.end(), [](double x) { return std::isnan(x); });
        result.push_back(known ? std::optional(vector) : std::nullopt);
        text.remove_prefix(end + 1);
    }
    return result;
}

// How many numbers a vector has: as many as the space has dimensions. Without a space, 0.
size_t space_dimension(const NrrdHeader& header) {
    if (header.optional("space")) return 3;
    const auto text = header.optional("spacedimension");
    if (!text) return 0;
    const auto dimension = parse_number<uint32_t>(*text);
    if (!dimension)
        fail(header.path, "space dimension: expected a whole number, found {}", quoted(*text));
    return *dimension;
}

void read_directions(const NrrdHeader& header, std::vector<Axis>& axes) {
    const auto directions = vectors(header, "spacedirections");
    if (directions.size() != axes.size())
        fail(header.path, "space directions: expected {} vectors, one for each axis, found {}",
             axes.size(), directions.size());
    size_t expected = space_dimension(header);
    for (size_t i = 0; i < axes.size(); ++i) {
        axes[i].direction = directions[i];
        if (!directions[i]) continue;
        const size_t found = directions[i]->size();
        if (found != 2 && found != 3)
            fail(header.path, "space directions: expected vectors of 2 or 3 numbers, found {}",
                 found);
        if (expected == 0) expected = found;
        if (found != expected)
            fail(header.path, "space directions: expected vectors of {} numbers, found {} in {}",
                 expected, found, quoted(header.required("spacedirections")));
    }
}

std::vector<Axis> read_axes(const NrrdHeader& header) {
    const auto dimension = parse_number<uint32_t>(header.required("dimension"));
    if (!dimension || *dimension < 1 || *dimension > 16)
        fail(header.path, "expected a dimension from 1 to 16, found {}",
             quoted(header.required("dimension")));
    std::vector<Axis> axes(*dimension);
    const auto sizes = per_axis(header, "sizes", axes.size());
    if (sizes.empty()) fail(header.path, "the NRRD header does not give \"sizes\"");
    const auto kinds = per_axis(header, "kinds", axes.size());
    const auto spacings = per_axis(header, "spacings", axes.size());
    const auto minima = per_axis(header, "axismins", axes.size());
    const auto maxima = per_axis(header, "axismaxs", axes.size());
    const auto centers =
        per_axis(header, header.optional("centers") ? "centers" : "centerings", axes.size());
    for (size_t i = 0; i < axes.size(); ++i) {
        const auto size = parse_number<uint32_t>(sizes[i]);
        if (!size || *size == 0)
            fail(header.path, "sizes: expected whole numbers from 1 to 4294967295, found {}",
                 quoted(sizes[i]));
        axes[i].size = *size;
        if (!kinds.empty()) axes[i].kind = lowercase(kinds[i]);
        if (!minima.empty()) axes[i].minimum = number(header, "axis mins", minima[i]);
        if (!maxima.empty()) axes[i].maximum = number(header, "axis maxs", maxima[i]);
        if (!centers.empty()) axes[i].cell_centered = lowercase(centers[i]) != "node";
        const double range = axes[i].maximum - axes[i].minimum;
        const auto samples = static_cast<double>(*size) - (axes[i].cell_centered ? 0 : 1);
        if (!spacings.empty() && !std::isnan(number(header, "spacings", spacings[i])))
            axes[i].spacing = number(header, "spacings", spacings[i]);
        else if (std::isfinite(range) && range != 0 && samples > 0)
            axes[i].spacing = range / samples;
    }
    if (header.optional("spacedirections")) read_directions(header, axes);
    return axes;
}

bool is_spatial(const Axis& axis, bool has_directions) {
    if (has_directions) return axis.direction.has_value();
    return axis.kind.empty() || axis.kind == "domain" || axis.kind == "space" ||
           axis.kind == "???" || axis.kind == "none";
}

// Drops axes of one sample that are not space; splits off time, the slowest axis.
std::vector<Axis> spatial_axes(const NrrdHeader& header, const std::vector<Axis>& axes,
                               uint64_t& steps) {
    const bool has_directions = header.optional("spacedirections").has_value();
    std::vector<Axis> spatial;
    for (size_t i = 0; i < axes.size(); ++i) {
        const bool last = i + 1 == axes.size();
        if (is_spatial(axes[i], has_directions) && !(last && spatial.size() == 3))
            spatial.push_back(axes[i]);
        else if (last && !axes[i].kind.ends_with("color") && !axes[i].kind.ends_with("vector"))
            steps = axes[i].size;
        else if (axes[i].size != 1)
            fail(header.path,
                 "axis {} holds {} values per voxel (kind {}); only scalar volumes, with time as "
                 "the last axis, can be read",
                 i, axes[i].size, quoted(axes[i].kind));
    }
    if (spatial.size() < 2 || spatial.size() > 3)
        fail(header.path,
             "expected 2 or 3 axes in space and perhaps one in time, found {} in space",
             spatial.size());
    return spatial;
}

std::array<double, 3> unit_normal(const Affine& affine) {
    const auto& m = affine.m;
    std::array<double, 3> n{m[1][0] * m[2][1] - m[2][0] * m[1][1],
                            m[2][0] * m[0][1] - m[0][0] * m[2][1],
                            m[0][0] * m[1][1] - m[1][0] * m[0][1]};
    const double length = std::hypot(n[0], n[1], n[2]);
    for (double& x : n)
        x /= length;
    return n;
}

void set_column(Affine& affine, size_t column, const std::vector<double>& vector) {
    for (size_t row = 0; row < 3; ++row)
        affine.m[row][column] = row < vector.size() ? vector[row] : 0;
}

Affine affine_of(const NrrdHeader& header, const std::vector<Axis>& spatial) {
    Affine affine;
    for (size_t i = 0; i < spatial.size(); ++i) {
        const Axis& axis = spatial[i];
        if (axis.direction) {
            set_column(affine, i, *axis.direction);
        } else {
            affine.m[i][i] = axis.spacing;
            if (std::isfinite(axis.minimum))
                affine.m[i][3] = axis.minimum + (axis.cell_centered ? axis.spacing / 2 : 0);
        }
    }
    if (spatial.size() == 2 && spatial[0].direction) {
        const auto normal = unit_normal(affine);
        if (!std::isfinite(normal[0] + normal[1] + normal[2]))
            fail(header.path, "space directions: expected two that span a plane, found {}",
                 quoted(header.required("spacedirections")));
        set_column(affine, 2, {normal.begin(), normal.end()});
    }
    if (header.optional("spaceorigin")) {
        const auto origin = vectors(header, "spaceorigin");
        if (origin.size() != 1 || !origin[0] || origin[0]->size() > 3)
            fail(header.path, "space origin: expected one vector like (0,0,0), found {}",
                 quoted(header.required("spaceorigin")));
        set_column(affine, 3, *origin[0]);
    }
    return affine;
}

// Anatomical spaces become RAS; the others are taken as they are.
void set_space(Volume& volume, const NrrdHeader& header) {
    const std::string space = lowercase(header.optional("space").value_or(""));
    const auto is = [&](std::string_view letters, std::string_view words) {
        return space == letters || space == words;
    };
    if (is("ras", "right-anterior-superior")) {
        volume.space = Space::ras;
    } else if (is("lps", "left-posterior-superior")) {
        volume.space = Space::ras;
        flip_world(volume.affine, {-1, -1, 1});
    } else if (is("las", "left-anterior-superior")) {
        volume.space = Space::ras;
        flip_world(volume.affine, {-1, 1, 1});
    } else if (space.ends_with("time") || is("rast", "last") || space == "lpst") {
        fail(header.path, "spaces that include time are not read, found {}", quoted(space));
    }
}

// The first that is not empty of: "mm" "mm" "mm". Without the quotes, the first word.
std::string first_unit(const NrrdHeader& header) {
    const std::string_view text =
        header.optional(header.optional("spaceunits") ? "spaceunits" : "units").value_or("");
    for (const std::string_view part : split(text, text.starts_with('"') ? "\"" : " \t\""))
        if (const std::string_view unit = trimmed(part); !unit.empty())
            return unit == "???" ? "" : length_unit(unit);
    return "";
}

}  // namespace

void set_nrrd_axes(Volume& volume, const NrrdHeader& header, const LoadOptions& options) {
    const std::vector<Axis> axes = read_axes(header);
    uint64_t steps = 1;
    const std::vector<Axis> spatial = spatial_axes(header, axes, steps);
    volume.dims = {1, 1, 1};
    for (size_t i = 0; i < spatial.size(); ++i)
        volume.dims[i] = static_cast<uint32_t>(spatial[i].size);
    set_time(volume, steps, options);
    volume.affine = affine_of(header, spatial);
    set_space(volume, header);
    volume.length_units = first_unit(header);
    if (volume.length_units.empty() && volume.space == Space::ras) volume.length_units = "mm";
    volume.value_units = unit_name(trimmed(header.optional("sampleunits").value_or("")));
}

}  // namespace isorast
