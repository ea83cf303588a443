// SPDX-License-Identifier: MIT
// Range, moments and histogram of a volume. 8 and 16 bit voxels are counted per level, and all else
// follows from the counts; wider types take two passes, or three with a value that stands for "no
// data". Threads share the work in fixed chunks, so
// the result does not depend on their number. Moments of chunks are merged as in Chan et al. 1979.
#include <isorast/error.h>
#include <isorast/volume.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>
#include <type_traits>
#include <utility>

#include "volume/voxels.h"

namespace isorast {
namespace {

constexpr uint64_t CHUNK = 1 << 20;    // voxels
constexpr uint64_t SAMPLED = 1 << 18;  // voxels of wide types that are ranked, about
constexpr uint64_t RANKS = 4096;       // steps

// Calls work(worker, chunk, first, last) for every chunk, on all cores.
template <class Work>
void for_chunks(uint64_t count, unsigned workers, Work&& work) {
    std::atomic<uint64_t> next{0};
    const auto run = [&](unsigned worker) {
        for (uint64_t chunk = next++; chunk * CHUNK < count; chunk = next++)
            work(worker, chunk, chunk * CHUNK, std::min(count, (chunk + 1) * CHUNK));
    };
    std::vector<std::jthread> threads;
    for (unsigned worker = 1; worker < workers; ++worker)
        threads.emplace_back(run, worker);
    run(0);
}

unsigned workers_for(uint64_t count) {
    const uint64_t chunks = (count + CHUNK - 1) / CHUNK;
    return static_cast<unsigned>(std::clamp<uint64_t>(std::thread::hardware_concurrency(), 1,
                                                      std::max<uint64_t>(chunks, 1)));
}

constexpr double INFINITE = std::numeric_limits<double>::infinity();

// "No data" lies at least so many times as far from other values as these lie apart, and these fall
// into so many bins of the histogram: labels and the like are data.
constexpr double FAR = 10;
constexpr ptrdiff_t FEW = 16;

struct Moments {
    double minimum = INFINITE, maximum = -INFINITE;
    double second = INFINITE, last_but_one = -INFINITE;  // next to these
    double mean = 0, squares = 0;  // squares: sum of squared distances from the mean
    uint64_t finite = 0, not_finite = 0;

    void widen(double value) {
        if (value < second && value != minimum)
            second = value < minimum ? std::exchange(minimum, value) : value;
        if (value > last_but_one && value != maximum)
            last_but_one = value > maximum ? std::exchange(maximum, value) : value;
    }

    void add(const Moments& other) {
        not_finite += other.not_finite;
        if (other.finite == 0) return;
        const auto a = static_cast<double>(finite), b = static_cast<double>(other.finite);
        const double distance = other.mean - mean;
        mean += distance * b / (a + b);
        squares += other.squares + distance * distance * a * b / (a + b);
        finite += other.finite;
        for (const double value : {other.minimum, other.maximum, other.second, other.last_but_one})
            if (std::isfinite(value)) widen(value);
    }

    std::optional<double> far_value() const {
        if (maximum - second > 0 && second - minimum > FAR * (maximum - second)) return minimum;
        if (last_but_one - minimum > 0 && maximum - last_but_one > FAR * (last_but_one - minimum))
            return maximum;
        return std::nullopt;
    }
};

// Sums are taken relative to the chunk's first finite value, which keeps their cancellation small.
template <class T>
Moments moments_of(const Volume& volume, uint64_t first, uint64_t last,
                   std::optional<double> left_out) {
    const std::byte* bytes = volume.bytes.span().data();
    Moments moments;
    double shift = 0, sum = 0, squares = 0;
    for (uint64_t index = first; index < last; ++index) {
        const double value = load_voxel<T>(bytes, index) * volume.slope + volume.intercept;
        if (!std::isfinite(value)) {
            ++moments.not_finite;
            continue;
        }
        if (value == left_out) continue;
        if (moments.finite++ == 0) shift = value;
        sum += value - shift;
        squares += (value - shift) * (value - shift);
        moments.widen(value);
    }
    if (moments.finite == 0) return moments;
    const auto count = static_cast<double>(moments.finite);
    moments.mean = shift + sum / count;
    moments.squares = std::max(0.0, squares - sum * sum / count);
    return moments;
}

// Which of `bins` equal bins a value falls into. Halves, so that a range of all doubles cannot
// overflow.
struct Binning {
    Binning(double low, double high, uint32_t count)
        : minimum(low / 2), range(high / 2 - low / 2), bins(count) {}
    size_t operator()(double value) const {
        if (!(range > 0)) return 0;
        return std::min<size_t>(static_cast<size_t>((value / 2 - minimum) / range * bins),
                                bins - 1);
    }
    double minimum, range;
    uint32_t bins;
};

void add_counts(std::vector<uint64_t>& sum, const std::vector<uint64_t>& counts) {
    for (size_t i = 0; i < sum.size(); ++i)
        sum[i] += counts[i];
}

void take(Statistics& result, const Moments& moments) {
    result.finite = moments.finite;
    result.not_finite = moments.not_finite;
    if (moments.finite == 0) return;
    result.minimum = moments.minimum;
    result.maximum = moments.maximum;
    result.mean = moments.mean;
    result.standard_deviation = std::sqrt(moments.squares / static_cast<double>(moments.finite));
}

// At RANKS + 1 equal steps of rank.
template <class ValueAt>
std::vector<double> ranks_of(uint64_t count, ValueAt&& value_at) {
    std::vector<double> ranked;
    for (uint64_t i = 0; i <= RANKS && count > 0; ++i)
        ranked.push_back(value_at(static_cast<uint64_t>(
            std::lround(static_cast<double>(i) / RANKS * static_cast<double>(count - 1)))));
    return ranked;
}

// Calls histogram = measure(left_out, moments, ranked) for all values, and once more without a far
// one if there is such.
template <class Measure>
Statistics without_far_value(Measure&& measure) {
    Moments all;
    Statistics result;
    result.histogram = measure(std::nullopt, all, result.ranked);
    take(result, all);
    const std::optional<double> no_data = all.far_value();
    if (!no_data) return result;
    Moments others;
    std::vector<double> ranked;
    const std::vector<uint64_t> histogram = measure(no_data, others, ranked);
    const auto bins = std::ranges::count_if(histogram, [](uint64_t count) { return count != 0; });
    if (bins < FEW) return result;
    take(result, others);
    result.histogram = histogram;
    result.ranked = ranked;
    result.no_data = no_data;
    result.without_data = all.finite - others.finite;
    return result;
}

// How often each raw level of an 8 or 16 bit type occurs, level 0 being the type's smallest value.
template <class T>
std::vector<uint64_t> count_levels(const Volume& volume) {
    constexpr size_t levels = size_t{1} << (8 * sizeof(T));
    constexpr int lowest = std::numeric_limits<T>::min();
    const unsigned workers = workers_for(volume.voxel_count());
    // Four tables per worker: runs of equal voxels would else wait for one counter.
    std::vector<std::vector<uint64_t>> counts(workers, std::vector<uint64_t>(4 * levels));
    const std::byte* bytes = volume.bytes.span().data();
    for_chunks(volume.voxel_count(), workers,
               [&](unsigned worker, uint64_t, uint64_t first, uint64_t last) {
                   uint64_t* table = counts[worker].data();
                   for (uint64_t index = first; index < last; ++index)
                       ++table[(index & 3) * levels +
                               static_cast<size_t>(load_voxel<T>(bytes, index) - lowest)];
               });
    std::vector<uint64_t> sum(levels);
    for (const auto& table : counts)
        for (size_t i = 0; i < table.size(); ++i)
            sum[i % levels] += table[i];
    return sum;
}

template <class T>
Statistics from_levels(const Volume& volume, uint32_t bins) {
    const std::vector<uint64_t> counts = count_levels<T>(volume);
    const auto value = [&](size_t level) {
        return (static_cast<double>(level) + std::numeric_limits<T>::min()) * volume.slope +
               volume.intercept;
    };
    return without_far_value(
        [&](std::optional<double> left_out, Moments& moments, std::vector<double>& ranked) {
            const auto for_levels = [&](auto&& take) {
                for (size_t level = 0; level < counts.size(); ++level)
                    if (counts[level] != 0 && value(level) != left_out)
                        take(value(level), counts[level]);
            };
            for_levels([&](double at, uint64_t count) {
                moments.add({.minimum = at, .maximum = at, .mean = at, .finite = count});
            });
            std::vector<uint64_t> histogram(bins);
            const Binning bin(moments.minimum, moments.maximum, bins);
            std::vector<std::pair<double, uint64_t>> ascending;  // and how many of these and before
            for_levels([&](double at, uint64_t count) {
                histogram[bin(at)] += count;
                ascending.emplace_back(at, count);
            });
            if (volume.slope < 0) std::ranges::reverse(ascending);
            for (size_t i = 1; i < ascending.size(); ++i)
                ascending[i].second += ascending[i - 1].second;
            auto level = ascending.begin();
            ranked = ranks_of(moments.finite, [&](uint64_t rank) {
                while (level->second <= rank)
                    ++level;
                return level->first;
            });
            return histogram;
        });
}

template <class T>
std::vector<double> sorted_sample(const Volume& volume, std::optional<double> left_out) {
    std::vector<double> values = sample_raw<T>(volume, SAMPLED);
    for (double& value : values)
        value = value * volume.slope + volume.intercept;
    std::erase_if(values, [&](double value) { return !std::isfinite(value) || value == left_out; });
    std::ranges::sort(values);
    return values;
}

template <class T>
Statistics from_voxels(const Volume& volume, uint32_t bins) {
    const uint64_t count = volume.voxel_count();
    const unsigned workers = workers_for(count);
    return without_far_value([&](std::optional<double> left_out, Moments& moments,
                                 std::vector<double>& ranked) {
        std::vector<Moments> chunks((count + CHUNK - 1) / CHUNK);
        for_chunks(count, workers, [&](unsigned, uint64_t chunk, uint64_t first, uint64_t last) {
            chunks[chunk] = moments_of<T>(volume, first, last, left_out);
        });
        for (const Moments& chunk : chunks)
            moments.add(chunk);

        const Binning bin(moments.minimum, moments.maximum, bins);
        std::vector<std::vector<uint64_t>> counts(workers, std::vector<uint64_t>(bins));
        const std::byte* bytes = volume.bytes.span().data();
        for_chunks(count, workers, [&](unsigned worker, uint64_t, uint64_t first, uint64_t last) {
            for (uint64_t index = first; index < last; ++index) {
                const double value = load_voxel<T>(bytes, index) * volume.slope + volume.intercept;
                if (std::isfinite(value) && value != left_out) ++counts[worker][bin(value)];
            }
        });
        std::vector<uint64_t> histogram(bins);
        for (const auto& table : counts)
            add_counts(histogram, table);
        std::vector<double> values = sorted_sample<T>(volume, left_out);
        if (!values.empty()) {
            values.front() = moments.minimum;
            values.back() = moments.maximum;
        }
        ranked = ranks_of(values.size(), [&](uint64_t rank) { return values[rank]; });
        return histogram;
    });
}

// A formula's voxels, for a volume that has not been sampled.
Volume sampled_copy(const Volume& volume) {
    Volume copy;
    copy.name = volume.name;
    copy.dims = volume.dims;
    copy.type = volume.type;
    copy.field = volume.field;
    copy.affine = volume.affine;
    copy.slope = volume.slope;
    copy.intercept = volume.intercept;
    sample(copy);
    return copy;
}

}  // namespace

Statistics statistics(const Volume& volume, uint32_t bins) {
    check(volume);
    if (bins == 0) throw Error("statistics: a histogram needs at least one bin");
    if (volume.bytes.span().empty()) return statistics(sampled_copy(volume), bins);
    return with_type(volume.type, [&](auto zero) {
        using T = decltype(zero);
        if constexpr (sizeof(T) <= 2)
            return from_levels<T>(volume, bins);
        else
            return from_voxels<T>(volume, bins);
    });
}

double Statistics::percentile(double percent) const {
    if (ranked.empty()) return maximum;
    const double rank =
        std::clamp(percent, 0.0, 100.0) / 100 * static_cast<double>(ranked.size() - 1);
    const auto below = static_cast<size_t>(rank), above = std::min(below + 1, ranked.size() - 1);
    const double t = rank - static_cast<double>(below);
    return ranked[below] * (1 - t) + ranked[above] * t;
}

}  // namespace isorast
