// SPDX-License-Identifier: MIT
// The scenarios of Kreskowski et al. 2022, section 4.1: resolution (figure 6), time series (7a),
// isovalue sweep (7b), stereo (8); and beyond the paper: motion, and volumes of all sizes.
#include "scenarios.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isorast::bench {

namespace {

using Sequences = std::vector<Sequence>;

constexpr size_t AFTER_CUT = 6;                       // frames from one cut to the next
constexpr size_t HELD_ISOVALUES = 6, HELD_STEPS = 3;  // that are also held still

// The surface fills the picture and stays within it.
Frame frame_of(Contest& contest, const Subject& subject, const Settings& settings, double isovalue,
               const std::string& size) {
    OrbitOptions options{.zoom = settings.zoom};
    if (subject.series.steps == 1) options.shown = contest.first().surface_hull({isovalue});
    return {.isovalues = {isovalue},
            .camera = orbit(subject.first, settings.azimuth, settings.elevation, options),
            .size = parse_size(size)};
}

Sequence still(const std::string& name, const Frame& frame, const Json& label = Json::object()) {
    return {.name = name, .rows = {label}, .shots = {{frame}}, .compared = {0}};
}

// At most `most` of 0 to count - 1, the first and the last among them.
std::vector<size_t> some_of(size_t count, size_t most) {
    std::vector<size_t> chosen;
    for (size_t i = 0; i < most; ++i)
        if (const size_t at = i * (count - 1) / (most - 1); chosen.empty() || chosen.back() != at)
            chosen.push_back(at);
    return chosen;
}

Sequences resolution(Contest& contest, const Subject& subject, const Settings& settings) {
    Sequences sequences;
    for (const std::string& size : settings.sizes)
        sequences.push_back(
            still("still", frame_of(contest, subject, settings, subject.isovalue, size)));
    return sequences;
}

// Each time step in turn, and some of them held.
Sequences time_series(Contest& contest, const Subject& subject, const Settings& settings) {
    Sequences sequences;
    const uint32_t steps = subject.series.steps;
    for (const std::string& size : settings.sizes) {
        Frame frame = frame_of(contest, subject, settings, subject.isovalue, size);
        Sequence series{.name = "series", .compared = {0, steps / 2}, .changes = true};
        for (frame.time_step = 0; frame.time_step < steps; ++frame.time_step)
            series.shots.push_back({frame});
        sequences.push_back(series);
        for (const size_t step : some_of(steps, HELD_STEPS)) {
            frame.time_step = uint32_t(step);
            sequences.push_back(still("held", frame, {{"step", step}}));
        }
    }
    return sequences;
}

// A new isovalue each frame, up and down again, which are not alike: a surface that shrinks
// uncovers what lies behind it. And some of them held.
Sequences isovalue_sweep(Contest& contest, const Subject& subject, const Settings& settings) {
    const auto [lowest, highest] = contest.first().value_range();
    const auto value_at = [&](double share) { return lowest + share * (highest - lowest); };
    const auto count = size_t(settings.sweep[2]);
    Sequences sequences;
    for (const std::string& size : settings.sizes) {
        Sequence sweep{.name = "sweep", .rows = {}, .changes = true};
        Frame frame = frame_of(contest, subject, settings, value_at(settings.sweep[0]), size);
        for (size_t i = 0; i < count; ++i) {
            const double along = count > 1 ? double(i) / double(count - 1) : 0;
            const double share = std::lerp(settings.sweep[0], settings.sweep[1], along);
            frame.isovalues = {value_at(share)};
            sweep.rows.push_back({{"isovalue", share}, {"towards", "higher"}});
            sweep.shots.push_back({frame, i});
        }
        // Each end once: every frame has another isovalue than the one before.
        for (size_t i = count; i-- > 2;) {
            sweep.shots.push_back({sweep.shots[i - 1].frame, sweep.rows.size()});
            sweep.rows.push_back(
                {{"isovalue", sweep.rows[i - 1]["isovalue"]}, {"towards", "lower"}});
        }
        sweep.compared = {0, count / 2, count - 1};
        sequences.push_back(sweep);
        for (const size_t i : some_of(count, HELD_ISOVALUES)) {
            const Json held{{"isovalue", sweep.rows[i]["isovalue"]}};
            sequences.push_back(still("held", sweep.shots[i].frame, held));
            sequences.back().compared.clear();
        }
    }
    return sequences;
}

Sequences stereo(Contest& contest, const Subject& subject, const Settings& settings) {
    Sequences sequences;
    for (const std::string& size : settings.sizes) {
        Frame frame = frame_of(contest, subject, settings, subject.isovalue, size);
        sequences.push_back(still("mono", frame));
        frame.stereo.mode = StereoMode::layers;
        sequences.push_back(still("stereo", frame));
    }
    return sequences;
}

// About the vertical through the target; the world's up is +z.
Camera turned(Camera camera, double degrees) {
    const double angle = degrees / 180 * std::numbers::pi;
    const double c = std::cos(angle), s = std::sin(angle);
    const auto turn = [&](std::array<double, 3>& v, const std::array<double, 3>& middle) {
        const double x = v[0] - middle[0], y = v[1] - middle[1];
        v[0] = middle[0] + c * x - s * y;
        v[1] = middle[1] + s * x + c * y;
    };
    turn(camera.position, camera.target);
    turn(camera.up, {0, 0, 0});
    return camera;
}

// There and back again, so that nothing jumps where the sequence begins anew.
Sequence orbit_by(const Frame& start, double degrees, size_t count) {
    Sequence sequence{.name = "orbit", .rows = {{{"degrees", degrees}}}, .compared = {count}};
    for (size_t i = 0; i < 2 * count; ++i) {
        Frame frame = start;
        frame.camera = turned(start.camera, degrees * double(i < count ? i : 2 * count - 1 - i));
        sequence.shots.push_back({frame});
    }
    return sequence;
}

// A quarter of a turn and back: the first frame after it is cold, the last one before is warm.
Sequence cut_of(const Frame& frame) {
    Sequence cut{.name = "cut", .rows = {{{"moment", "cold"}}, {{"moment", "warm"}}}};
    for (size_t i = 0; i < 2 * AFTER_CUT; ++i) {
        Frame shown = frame;
        if (i >= AFTER_CUT) shown.camera = turned(frame.camera, 90);
        const size_t since = i % AFTER_CUT;
        cut.shots.push_back({shown, since == 0 ? 0 : since == AFTER_CUT - 1 ? 1 : NOT_COUNTED});
    }
    return cut;
}

Sequences motion(Contest& contest, const Subject& subject, const Settings& settings) {
    Sequences sequences;
    for (const std::string& size : settings.sizes) {
        const Frame frame = frame_of(contest, subject, settings, subject.isovalue, size);
        sequences.push_back(still("still", frame));
        for (const double degrees : settings.degrees)
            sequences.push_back(orbit_by(frame, degrees, std::max(settings.frames / 4, 2u)));
        sequences.push_back(cut_of(frame));
    }
    return sequences;
}

// Each of the formulas with 64^3 voxels, 128^3, ... to side^3.
std::vector<std::string> at_all_sides(uint32_t from, uint32_t to) {
    std::vector<std::string> volumes;
    for (const std::string formula : {"head", "bone"})
        for (uint32_t side = from; side <= to; side *= 2)
            volumes.push_back(fmt::format("{}:{}:type=u8", formula, side));
    return volumes;
}

}  // namespace

// Stand-ins for the paper's table 1: CT Head, Vertebra, Chameleon, Supernova.
const std::vector<Scenario>& scenarios() {
    static const Choice PAPER{{"head:256:type=u8", "vessels:512:type=u8", "bone:1024:type=u16"},
                              {"head:64:type=u8", "vessels:128:type=u8", "bone:128:type=u16"}};
    static const Choice NOISY{{PAPER.full[2]}, {"bone:64:type=u16"}};
    static const Choice SERIES{{"coral:512:type=f32:steps=30"}, {"coral:64:type=f32:steps=6"}};
    static const Choice ALL{{PAPER.full[0], PAPER.full[1], PAPER.full[2], "coral:512:type=f32"},
                            {PAPER.quick[0], PAPER.quick[1], PAPER.quick[2], "coral:64:type=f32"}};
    static const Choice SIDES{at_all_sides(64, 2048), at_all_sides(32, 128)};
    static const Choice UHD{{"3840x2160"}, {"320x180"}};
    static const Choice SIZES{{"1280x720", "1920x1080", "2560x1440", "3840x2160", "7680x4320"},
                              {"160x90", "240x135", "320x180"}};
    static const std::vector<Scenario> KNOWN{
        {"frames", "a still picture", PAPER, UHD, 40, true, resolution},
        {"resolution", "figure 6: draw time against resolution", PAPER, SIZES, 40, true,
         resolution},
        {"time-series", "figure 7a: a new time step each frame", SERIES, SIZES, 20, true,
         time_series},
        {"isovalue-sweep", "figure 7b: a new isovalue each frame", NOISY, UHD, 20, false,
         isovalue_sweep},
        {"stereo", "figure 8: two eyes against one", ALL, UHD, 40, true, stereo},
        {"motion", "orbits, and a cut to another camera", NOISY, UHD, 40, true, motion},
        {"scaling", "volumes of 64^3 to 2048^3", SIDES, UHD, 40, false, resolution},
    };
    return KNOWN;
}

Settings with_defaults(Settings settings, const Scenario& scenario) {
    const auto choose = [&](std::vector<std::string>& chosen, const Choice& choice) {
        if (chosen.empty()) chosen = settings.quick ? choice.quick : choice.full;
    };
    choose(settings.volumes, scenario.volumes);
    choose(settings.sizes, scenario.sizes);
    if (settings.frames == 0) settings.frames = settings.quick ? 4 : scenario.frames;
    if (settings.quick) {
        settings.warm_up = 1;
        settings.warm_up_ms = 0;
        settings.sweep[2] = std::min(settings.sweep[2], 5.0);
    }
    const auto known = techniques();
    if (settings.ways.empty())
        for (const std::string words : {"direct hardware", "direct compute", "raymarch hardware",
                                        "raymarch compute", "meshlets"}) {
            const Way way = parse_way(words);
            if (way.stored() && !scenario.stored) continue;
            if (std::ranges::count(known, way.options.technique)) settings.ways.push_back(words);
        }
    for (const std::string& words : settings.ways)
        parse_way(words);
    for (const std::string& size : settings.sizes)
        parse_size(size);
    return settings;
}

}  // namespace isorast::bench
