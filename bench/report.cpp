// SPDX-License-Identifier: MIT
// Tables of what was measured, by lane.
#include "report.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace isorast::bench {

namespace {

constexpr size_t MOST_ROWS = 3;  // of one way in a table; more are averaged

// A line of a table.
struct Line {
    std::string way, lane, label;
    double median_ms = 0, p95_ms = 0;
    size_t rows = 0;
    std::string rest;
};

// What is not told by the table's heading: "isovalue 0.5", "cold".
std::string label_of(const Json& row) {
    if (row.contains("isovalue"))
        return fmt::format("isovalue {:.3g}", row["isovalue"].get<double>());
    if (row.contains("step")) return fmt::format("step {}", row["step"].get<int>());
    if (row.contains("moment")) return row["moment"].get<std::string>();
    if (row.contains("degrees")) return fmt::format("{:g} degrees", row["degrees"].get<double>());
    return "";
}

std::string passes_of(const Json& row) {
    std::string line;
    for (const auto& [name, pass] : row["passes"].items())
        line += fmt::format("{} {:.3f}  ", name, pass["median_ms"].get<double>());
    const uint64_t active = row["blocks_active"];
    if (active > 0)
        line += fmt::format("drawn {} of {}  ", row["blocks_drawn"].get<uint64_t>(), active);
    return line + fmt::format("extra {:.2f} %", 100 * row["extra_bytes"].get<double>() /
                                                    row["volume_bytes"].get<double>());
}

std::string heading_of(const Json& row) {
    return fmt::format("{}, {}x{}, {}", row["volume"].get<std::string>(),
                       row["width"].get<uint32_t>(), row["height"].get<uint32_t>(),
                       row["sequence"].get<std::string>());
}

// Rows of one way become one line, their means, where there are many.
std::vector<Line> lines_of(const std::vector<const Json*>& rows) {
    std::map<std::string, size_t> counts;
    for (const Json* row : rows)
        ++counts[(*row)["way"].get<std::string>()];
    std::vector<Line> lines;
    for (const Json* row : rows) {
        const std::string way = (*row)["way"];
        const bool many = counts[way] > MOST_ROWS;
        auto line = std::ranges::find(lines, way, &Line::way);
        if (!many || line == lines.end()) {
            const std::string label =
                many ? fmt::format("mean of {}", counts[way]) : label_of(*row);
            lines.push_back({way, (*row)["lane"], label});
            line = lines.end() - 1;
            if (!many) line->rest = passes_of(*row);
        }
        line->median_ms += (*row)["frame"]["median_ms"].get<double>();
        line->p95_ms += (*row)["frame"]["p95_ms"].get<double>();
        ++line->rows;
    }
    for (Line& line : lines) {
        line.median_ms /= double(line.rows);
        line.p95_ms /= double(line.rows);
    }
    return lines;
}

std::string technique_of(const Line& line) {
    return line.way.substr(0, line.way.find(' '));
}

// The best line of each technique in a lane (any lane: ""), all against the first technique's.
void print_ratios(const std::vector<Line>& lines, const std::string& lane,
                  const std::string& label) {
    std::vector<const Line*> best;
    for (const Line& line : lines) {
        if ((!lane.empty() && line.lane != lane) || line.label != label) continue;
        const auto known = std::ranges::find(
            best, technique_of(line), [](const Line* other) { return technique_of(*other); });
        if (known == best.end())
            best.push_back(&line);
        else if (line.median_ms < (*known)->median_ms)
            *known = &line;
    }
    if (best.size() < 2) return;
    std::string text;
    for (size_t i = 1; i < best.size(); ++i)
        text += fmt::format("{}{} / {} = {:.2f}", i > 1 ? ", " : "", best[i]->way, best[0]->way,
                            best[i]->median_ms / best[0]->median_ms);
    fmt::print("  {:<9}{}{}{}\n", lane.empty() ? "best" : lane, label, label.empty() ? "" : ": ",
               text);
}

}  // namespace

void print_tables(const Json& rows, size_t first) {
    for (size_t begin = first; begin < rows.size();) {
        const std::string heading = heading_of(rows[begin]);
        std::vector<const Json*> together;
        for (; begin < rows.size() && heading_of(rows[begin]) == heading; ++begin)
            together.push_back(&rows[begin]);
        const std::vector<Line> lines = lines_of(together);
        fmt::print("{}\n", heading);
        std::vector<std::string> labels;
        for (const std::string lane : {"graphics", "compute"})
            for (const Line& line : lines) {
                if (line.lane != lane) continue;
                fmt::print("  {:<9}{:<26}{:<14}{:9.3f} ms  p95 {:9.3f}   {}\n", lane, line.way,
                           line.label, line.median_ms, line.p95_ms, line.rest);
                if (!std::ranges::count(labels, line.label)) labels.push_back(line.label);
            }
        for (const std::string& label : labels)
            for (const std::string lane : {"graphics", "compute", ""})
                print_ratios(lines, lane, label);
    }
    std::fflush(stdout);
}

}  // namespace isorast::bench
