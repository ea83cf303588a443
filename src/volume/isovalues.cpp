// SPDX-License-Identifier: MIT
// From words to isovalues, and the isovalue to begin with: the threshold that maximises the
// variance between the two classes it makes (Otsu 1979, "A threshold selection method from
// gray-level histograms").
#include <isorast/volume.h>

#include <algorithm>
#include <cmath>

#include "volume/field.h"
#include "volume/text.h"

namespace isorast {
namespace {

constexpr size_t MOST_ISOVALUES = 32;

// Where all but a few values lie.
struct Core {
    double low, high;
};

Core core_of(const Statistics& statistics) {
    const Core core{statistics.percentile(0.05), statistics.percentile(99.95)};
    const double all = statistics.maximum / 2 - statistics.minimum / 2;
    if (core.high > core.low && (core.high / 2 - core.low / 2) * 10 < all) return core;
    return {statistics.minimum, statistics.maximum};
}

// Of these; values beyond count in the last bins.
std::vector<uint64_t> histogram_of(const Statistics& statistics, const Core& core) {
    if (core.low == statistics.minimum && core.high == statistics.maximum)
        return statistics.histogram;
    std::vector<uint64_t> histogram(256);
    for (const double value : statistics.ranked) {
        const double t = std::clamp((value - core.low) / (core.high - core.low), 0.0, 1.0);
        ++histogram[std::min(size_t(t * 256), size_t{255})];
    }
    return histogram;
}

// A few values far from all others, such as noise or metal, would draw the threshold to them.
double otsu(const Statistics& statistics) {
    const Core core = core_of(statistics);
    const std::vector<uint64_t> histogram = histogram_of(statistics, core);
    double total = 0, weighted_total = 0;
    for (size_t bin = 0; bin < histogram.size(); ++bin) {
        total += static_cast<double>(histogram[bin]);
        weighted_total += static_cast<double>(histogram[bin]) * static_cast<double>(bin);
    }
    double count = 0, weighted = 0, best = -1;
    size_t first_best = 0, last_best = 0;
    for (size_t bin = 0; bin + 1 < histogram.size(); ++bin) {
        count += static_cast<double>(histogram[bin]);
        weighted += static_cast<double>(histogram[bin]) * static_cast<double>(bin);
        if (count == 0 || count == total) continue;
        const double distance = weighted / count - (weighted_total - weighted) / (total - count);
        const double between = count * (total - count) * distance * distance;
        if (between > best) {
            best = between;
            first_best = bin;
        }
        if (between >= best) last_best = bin;
    }
    if (best < 0) return statistics.minimum;  // a constant volume: there is nothing to separate
    // Empty bins leave the variance as it is: cut in the middle of the gap.
    const double t = (static_cast<double>(first_best + last_best) / 2 + 1) /
                     static_cast<double>(histogram.size());
    return core.low * (1 - t) + core.high * t;
}

// Whole and finite, or nothing.
std::optional<double> parse_finite(std::string_view text) {
    const auto number = parse_number<double>(trimmed(text));
    return number && std::isfinite(*number) ? number : std::nullopt;
}

[[noreturn]] void reject(std::string_view word, std::string_view reason) {
    throw Error(fmt::format("isovalue {}: {}", quoted(word), reason));
}

void add_range(std::string_view word, std::vector<double>& isovalues) {
    const size_t first_colon = word.find(':');
    const size_t second_colon = word.find(':', first_colon + 1);
    if (second_colon == std::string_view::npos) reject(word, "a range is FIRST:LAST:STEP");
    const auto first = parse_finite(word.substr(0, first_colon));
    const auto last = parse_finite(word.substr(first_colon + 1, second_colon - first_colon - 1));
    const auto step = parse_finite(word.substr(second_colon + 1));
    if (!first || !last || !step) reject(word, "a range is FIRST:LAST:STEP, three numbers");
    if (*step == 0) reject(word, "the step of a range must not be 0");
    const double steps = (*last - *first) / *step;
    if (steps < 0) reject(word, "the step of a range must lead from its first to its last value");
    // The last value belongs to the range even where the division rounds down: 0:0.3:0.1.
    const double count = std::floor(steps + 1e-9) + 1;
    if (!(count + static_cast<double>(isovalues.size()) <= MOST_ISOVALUES))
        reject(word, fmt::format("more than {} isovalues; take a larger step", MOST_ISOVALUES));
    for (int i = 0; i < static_cast<int>(count); ++i)
        isovalues.push_back(*first + i * *step);
}

// One word that is not a range. `known` gives the statistics, taken at the first call.
template <class Known>
double single(std::string_view word, const Volume& volume, Known&& known) {
    if (const auto number = parse_finite(word)) return *number;
    if (word == "auto")
        return volume.field ? field_isovalue(*volume.field) : suggest_isovalue(volume, known());
    if (word.starts_with('p')) {
        const auto percent = parse_finite(word.substr(1));
        if (percent && *percent >= 0 && *percent <= 100) return known().percentile(*percent);
        reject(word, "a percentile is p0 to p100");
    }
    if (word.ends_with("sigma")) {
        if (const auto times = parse_finite(word.substr(0, word.size() - 5)))
            return known().mean + *times * known().standard_deviation;
    }
    reject(word, "expected a number, FIRST:LAST:STEP, pNN (a percentile), Nsigma or auto");
}

}  // namespace

double suggest_isovalue(const Volume& volume, const Statistics& statistics) {
    return volume.field ? field_isovalue(*volume.field) : otsu(statistics);
}

std::vector<double> parse_isovalues(std::string_view text, const Volume& volume) {
    std::optional<Statistics> cache;
    const auto known = [&]() -> const Statistics& {
        if (!cache) cache = statistics(volume);
        return *cache;
    };
    std::vector<double> isovalues;
    for (size_t start = 0; start <= text.size();) {
        const size_t comma = std::min(text.find(',', start), text.size());
        const std::string_view word = trimmed(text.substr(start, comma - start));
        start = comma + 1;
        if (word.find(':') != std::string_view::npos)
            add_range(word, isovalues);
        else
            isovalues.push_back(single(word, volume, known));
        if (isovalues.size() > MOST_ISOVALUES)
            reject(word, fmt::format("more than {} isovalues", MOST_ISOVALUES));
    }
    return isovalues;
}

}  // namespace isorast
