// SPDX-License-Identifier: MIT
// A contest: agreement first, then two rounds, the second in the opposite order.
#include "measure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <isorast/error.h>

#include <algorithm>
#include <chrono>

#include "image/state.h"
#include "statistics.h"

namespace isorast::bench {

namespace {

using Clock = std::chrono::steady_clock;

constexpr uint32_t ROUNDS = 2;
// Frames shorter than this are measured SHORT_TIMES as often: 200 frames in place of 40.
constexpr double SHORT_MS = 2;
constexpr uint32_t SHORT_TIMES = 5, LEAST_FOR_SHORT = 20;
constexpr uint32_t TOGETHER = 100;  // short frames submitted without a wait, to warm up
// Ways that differ by more do not draw the same surface: 3 voxels on average, or a hundredth of the
// volume, as one speck that half-cell steps pass over is as wrong as what lies behind it is far.
constexpr double LEAST_OVERLAP = 0.9, MOST_DEPTH_VOXELS = 3, MOST_DEPTH_SHARE = 0.01;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::vector<Frame> frames_of(const Sequence& sequence, const Way& way) {
    std::vector<Frame> frames;
    for (const auto& shot : sequence.shots)
        frames.push_back(way.of(shot.frame));
    return frames;
}

// "1280x720 still"
std::string title(const Sequence& sequence) {
    const Size size = sequence.shots.front().frame.size;
    return fmt::format("{}x{} {}", size.width, size.height, sequence.name);
}

Difference worse(const Difference& a, const Difference& b) {
    return {std::min(a.overlap, b.overlap), std::max(a.depth_voxels, b.depth_voxels)};
}

// How often the rarest row is in the sequence.
size_t least_count(const Sequence& sequence) {
    std::vector<size_t> counts(sequence.rows.size());
    for (const auto& shot : sequence.shots)
        if (shot.row != NOT_COUNTED) ++counts[shot.row];
    return std::ranges::min(counts);
}

}  // namespace

Contest::Contest(Gpu& gpu, const Subject& subject, const Settings& settings, Json& report)
    : gpu_(gpu), subject_(subject), settings_(settings), report_(report) {
    const double bytes = 1.1 * double(subject.first.byte_count()) * subject.series.steps;
    all_fit_ = bytes * double(settings.ways.size()) < 0.7 * double(gpu.info().memory_bytes);
    for (const std::string& words : settings.ways) {
        Contender contender{.way = parse_way(words), .lane = "", .renderer = nullptr};
        try {
            const Rasterizer rasterizer = renderer(contender).rasterizer();
            contender.lane = rasterizer == Rasterizer::hardware ? "graphics" : "compute";
        } catch (const Error& error) {
            skip(words, subject.name, error.what());
            continue;
        }
        release(contender);
        contenders_.push_back(std::move(contender));
    }
}

Renderer& Contest::renderer(Contender& contender) {
    if (!contender.renderer)
        contender.renderer =
            std::make_unique<Renderer>(gpu_, subject_.series, contender.way.options);
    return *contender.renderer;
}

void Contest::release(Contender& contender) {
    if (!all_fit_) contender.renderer.reset();
}

void Contest::skip(const std::string& way, const std::string& where, const std::string& why) {
    // The same for each volume: said once.
    const bool known = std::ranges::any_of(report_["skipped"], [&](const Json& other) {
        return other["way"] == way && other["why"] == why;
    });
    if (!known) fmt::print("  left out: {}, {}: {}\n", way, where, why);
    report_["skipped"].push_back({{"volume", subject_.name}, {"way", way}, {"why", why}});
}

void Contest::compare(const Sequence& sequence, std::vector<Taken>& taken) {
    const auto spacing = subject_.first.affine.spacing();
    const double most_depth =
        std::max(MOST_DEPTH_VOXELS, MOST_DEPTH_SHARE * std::ranges::max(subject_.first.dims));
    std::vector<Image> truth;  // of the first way that draws the sequence
    std::string true_way;
    for (size_t i = 0; i < contenders_.size(); ++i) {
        Contender& contender = contenders_[i];
        taken[i].left_out = sequence.changes && contender.way.stored();
        if (taken[i].left_out || sequence.compared.empty()) continue;
        try {
            std::vector<Image> images = pictures_of(contender, sequence);
            if (truth.empty()) {
                truth = std::move(images);
                true_way = contender.way.words;
                continue;
            }
            Difference found;
            for (size_t n = 0; n < truth.size(); ++n)
                found = worse(found, difference(images[n], truth[n], std::ranges::min(spacing)));
            contender.worst = worse(found, contender.worst.value_or(found));
            contender.others.insert(true_way);
            report_["agreement"].push_back({{"volume", subject_.name},
                                            {"sequence", title(sequence)},
                                            {"way", contender.way.words},
                                            {"overlap", found.overlap},
                                            {"depth_voxels", found.depth_voxels}});
            if (found.overlap < LEAST_OVERLAP || found.depth_voxels > most_depth)
                throw Error(
                    fmt::format("another picture than {}: silhouettes overlap by {:.3f}, "
                                "depths differ by {:.2f} voxels",
                                true_way, found.overlap, found.depth_voxels));
        } catch (const Error& error) {
            taken[i].left_out = true;
            skip(contender.way.words, title(sequence), error.what());
        }
    }
}

std::vector<Image> Contest::pictures_of(Contender& contender, const Sequence& sequence) {
    std::vector<Image> images;
    for (const size_t shot : sequence.compared) {
        Frame frame = contender.way.of(sequence.shots[shot].frame);
        frame.want_depth = true;
        images.push_back(renderer(contender).render(frame));
    }
    release(contender);
    return images;
}

void Contest::print_agreement() const {
    for (const Contender& contender : contenders_)
        if (contender.worst)
            fmt::print("  agreement of {} with {}: overlap {:.5f}, depth {:.3f} voxels\n",
                       contender.way.words, fmt::join(contender.others, ", "),
                       contender.worst->overlap, contender.worst->depth_voxels);
}

void Contest::take_round(Contender& contender, const Sequence& sequence, Taken& taken) {
    auto& state = renderer(contender).state();
    const std::vector<Frame> frames = frames_of(sequence, contender.way);
    // Many frames at once, so that the device never waits and its clocks rise.
    std::vector<Frame> together;
    while (together.size() < TOGETHER)
        together.insert(together.end(), frames.begin(), frames.end());
    std::vector<double> warm;
    const auto start = Clock::now();
    while (warm.size() < settings_.warm_up || milliseconds_since(start) < settings_.warm_up_ms) {
        const bool is_short = !warm.empty() && warm.back() < SHORT_MS;
        for (const auto& frame : state.run(is_short ? together : frames))
            warm.push_back(frame_ms(frame));
    }

    const size_t least = least_count(sequence);
    size_t passes = (settings_.frames + ROUNDS * least - 1) / (ROUNDS * least);
    if (settings_.frames >= LEAST_FOR_SHORT && quantile(warm, 0.5) < SHORT_MS)
        passes *= SHORT_TIMES;
    std::vector<Frame> all;
    for (size_t i = 0; i < passes; ++i)
        all.insert(all.end(), frames.begin(), frames.end());
    const auto counted = Clock::now();
    const auto times = state.run(all);
    taken.wall_ms += milliseconds_since(counted);
    taken.wall_frames += times.size();

    std::vector<std::vector<double>> round(sequence.rows.size());
    for (size_t i = 0; i < times.size(); ++i) {
        const size_t row = sequence.shots[i % sequence.shots.size()].row;
        if (row == NOT_COUNTED) continue;
        round[row].push_back(frame_ms(times[i]));
        taken.frames[row].push_back(times[i]);
    }
    for (size_t row = 0; row < round.size(); ++row)
        taken.rounds_ms[row].push_back(quantile(round[row], 0.5));
}

// Counts of blocks are read back: not in the frames that are timed.
void Contest::count(Contender& contender, const Sequence& sequence, Taken& taken) {
    for (const auto& shot : sequence.shots) {
        renderer(contender).render(contender.way.of(shot.frame));
        if (shot.row == NOT_COUNTED) continue;
        taken.stats[shot.row] = renderer(contender).stats();
    }
}

void Contest::add_rows(const Contender& contender, const Sequence& sequence, const Taken& taken) {
    for (size_t row = 0; row < sequence.rows.size(); ++row) {
        const Size size = sequence.shots.front().frame.size;
        Json json{{"volume", subject_.name},    {"sequence", sequence.name},
                  {"way", contender.way.words}, {"lane", contender.lane},
                  {"width", size.width},        {"height", size.height}};
        json.update(sequence.rows[row]);
        json.update(summarize(taken.frames[row]));
        json["rounds_ms"] = taken.rounds_ms[row];
        json["wall_ms"] = taken.wall_ms / double(taken.wall_frames);
        const FrameStats& stats = taken.stats[row];
        json["blocks"] = stats.blocks;
        json["blocks_active"] = stats.blocks_active;
        json["blocks_drawn"] = stats.blocks_drawn;
        json["volume_bytes"] = stats.volume_bytes;
        json["extra_bytes"] = stats.extra_bytes;
        json["target_bytes"] = stats.target_bytes;
        report_["rows"].push_back(json);
    }
}

void Contest::measure(const std::vector<Sequence>& sequences) {
    std::vector<std::vector<Taken>> taken(sequences.size());
    for (size_t s = 0; s < sequences.size(); ++s) {
        const size_t rows = sequences[s].rows.size();
        Taken none;
        none.frames.resize(rows);
        none.rounds_ms.resize(rows);
        none.stats.resize(rows);
        taken[s].resize(contenders_.size(), none);
        compare(sequences[s], taken[s]);
    }
    print_agreement();
    for (uint32_t round = 0; round < ROUNDS; ++round) {
        for (size_t n = 0; n < contenders_.size(); ++n) {
            const size_t i = round == 0 ? n : contenders_.size() - 1 - n;
            for (size_t m = 0; m < sequences.size(); ++m) {
                const size_t s = round == 0 ? m : sequences.size() - 1 - m;
                if (taken[s][i].left_out) continue;
                take_round(contenders_[i], sequences[s], taken[s][i]);
                if (round == 0) count(contenders_[i], sequences[s], taken[s][i]);
            }
            release(contenders_[i]);
        }
    }
    for (size_t s = 0; s < sequences.size(); ++s)
        for (size_t i = 0; i < contenders_.size(); ++i)
            if (!taken[s][i].left_out) add_rows(contenders_[i], sequences[s], taken[s][i]);
}

}  // namespace isorast::bench
