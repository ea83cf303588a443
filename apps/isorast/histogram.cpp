// SPDX-License-Identifier: MIT
// A histogram drawn with block characters; see histogram.h.
#include "histogram.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace isorast::cli {
namespace {

constexpr size_t ROWS = 8;
constexpr const char* EIGHTHS[] = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};

// How many different values whole-number voxels can take in the range; 0 for too many and for
// floats.
size_t levels_of(const Statistics& statistics, const Volume& volume) {
    if (volume.type == VoxelType::f32 || volume.type == VoxelType::f64) return 0;
    const double levels = (statistics.maximum - statistics.minimum) / std::abs(volume.slope) + 1;
    return levels <= static_cast<double>(statistics.histogram.size()) ? size_t(std::lround(levels))
                                                                      : 0;
}

// The histogram's bins summed up into at most `width` columns. Few levels are spread evenly: else
// columns with one level more than their neighbours would look like a comb.
std::vector<uint64_t> columns_of(const Statistics& statistics, size_t levels, size_t width) {
    const size_t bins = statistics.histogram.size();
    size_t columns = std::min(width, bins);
    if (levels > 0) {
        const size_t levels_each = (levels + width - 1) / width;
        columns = (levels + levels_each - 1) / levels_each;
    }
    std::vector<uint64_t> counts(columns);
    for (size_t bin = 0; bin < bins; ++bin) {
        size_t column = bin * columns / bins;
        if (levels > 1) {
            const size_t level = (bin * (levels - 1) + bins - 1) / bins;
            column = (bin + 1 == bins ? levels - 1 : level) * columns / levels;
        }
        counts[column] += statistics.histogram[bin];
    }
    return counts;
}

// A text around `column`, kept inside `width`.
std::string placed(const std::string& text, size_t column, size_t width) {
    const size_t half = text.size() / 2;
    const size_t start =
        std::min(column > half ? column - half : 0, width > text.size() ? width - text.size() : 0);
    return std::string(start, ' ') + text;
}

std::string axis_labels(const Statistics& statistics, size_t width) {
    const std::string low = fmt::format("{:.6g}", statistics.minimum);
    const std::string high = fmt::format("{:.6g}", statistics.maximum);
    const std::string middle =
        fmt::format("{:.6g}", statistics.minimum / 2 + statistics.maximum / 2);
    if (low.size() + high.size() + middle.size() + 4 > width) {
        return fmt::format("{} to {}", low, high);
    }
    std::string line = placed(middle, width / 2, width);
    line.replace(0, low.size(), low);
    line.resize(width - high.size(), ' ');
    return line + high;
}

}  // namespace

std::string draw_histogram(const Statistics& statistics, const Volume& volume, double isovalue,
                           size_t width) {
    const double range = statistics.maximum - statistics.minimum;
    if (statistics.finite == 0 || !(range > 0)) return "";  // nothing to draw
    const size_t levels = levels_of(statistics, volume);
    const std::vector<uint64_t> counts = columns_of(statistics, levels, width);
    const double most = std::log1p(static_cast<double>(*std::ranges::max_element(counts)));

    // Stack eighths of a row; a column that is not empty shows at least one.
    std::string text;
    for (size_t row = ROWS; row-- > 0;) {
        for (uint64_t count : counts) {
            const double height = std::log1p(static_cast<double>(count)) / most * ROWS * 8;
            const long eighths = count == 0 ? 0 : std::max(1L, std::lround(height));
            text += EIGHTHS[std::clamp(eighths - long(row) * 8, 0L, 8L)];
        }
        text += '\n';
    }
    for (size_t i = 0; i < counts.size(); ++i)
        text += "─";
    text += '\n' + axis_labels(statistics, counts.size()) + '\n';

    // A level fills a share of the axis; a real number is a point on it.
    const double step = levels > 0 ? range / static_cast<double>(levels - 1) : 0;
    const double at = std::clamp((isovalue - statistics.minimum) / (range + step), 0.0, 1.0);
    const size_t column = std::min(counts.size() - 1, size_t(at * double(counts.size())));
    text += std::string(column, ' ') + "▲\n";
    text += placed(fmt::format("iso {:.6g}", isovalue), column, counts.size()) + '\n';
    return text;
}

size_t terminal_width() {
    winsize size{};
    size_t width = 80;
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
        width = size.ws_col;
    } else if (const char* columns = std::getenv("COLUMNS"); columns && std::atoi(columns) > 0) {
        width = static_cast<size_t>(std::atoi(columns));
    }
    return std::clamp<size_t>(width, 20, 160);
}

}  // namespace isorast::cli
