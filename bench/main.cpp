// SPDX-License-Identifier: MIT
// isorast-bench: GPU times of whole frames and their passes, as tables and as JSON. It links the
// core only, so that a binary built on one machine runs on another that has a Vulkan driver and
// little else.
//
//   isorast-bench resolution -o resolution.json
//   isorast-bench frames --volumes coral:256:type=u8 bonsai_256x256x256_uint8.raw@40
//   isorast-bench isovalue-sweep --quick      a small one, for drivers on the CPU
#include <fmt/format.h>
#include <isorast/error.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <fstream>

#include "commit.h"
#include "report.h"
#include "scenarios.h"

namespace {

using namespace isorast;
using namespace isorast::bench;

void add_options(CLI::App& app, Settings& settings) {
    std::string names;
    for (const Scenario& scenario : scenarios())
        names += fmt::format("\n  {:<16}{}", scenario.name, scenario.what);
    app.footer("Scenarios:" + names);
    app.add_option("scenario", settings.scenario, "one of those below")->required();
    app.add_option("--volumes", settings.volumes,
                   "formulas, NAME_WxHxD_TYPE.raw files, or folders of them (time steps); with "
                   "@ISOVALUE behind, or their own");
    app.add_option("--ways", settings.ways,
                   "e.g. 'direct hardware,raymarch compute exact'; else all that the device can do")
        ->delimiter(',');
    app.add_option("--sizes", settings.sizes, "e.g. 1280x720,3840x2160")->delimiter(',');
    app.add_option("--sequences", settings.sequences, "only those, e.g. sweep or orbit; else all")
        ->delimiter(',');
    app.add_option("--frames", settings.frames, "counted ones for each row, in two rounds");
    app.add_option("--warm-up", settings.warm_up, "frames before, not counted");
    app.add_option("--warm-up-ms", settings.warm_up_ms, "and at least so long");
    app.add_option("--sweep", settings.sweep,
                   "isovalue-sweep: first, last (shares of the value range), how many")
        ->delimiter(',')
        ->expected(3);
    app.add_option("--degrees", settings.degrees, "motion: of the orbits, a frame")->delimiter(',');
    app.add_option("--azimuth", settings.azimuth);
    app.add_option("--elevation", settings.elevation);
    app.add_option("--zoom", settings.zoom);
    app.add_flag("--shots", settings.shots,
                 "write each frame's camera and isovalues, too, for others to draw the same");
    app.add_flag("--quick", settings.quick, "small volumes and pictures, few frames");
    app.add_option("--device", settings.device, "as for isorast render");
    app.add_option("-o,--output", settings.output, "JSON file");
}

const Scenario& scenario_of(const Settings& settings) {
    std::string names;
    for (const Scenario& scenario : scenarios()) {
        if (scenario.name == settings.scenario) return scenario;
        names += (names.empty() ? "" : ", ") + scenario.name;
    }
    throw Error(fmt::format("scenario: expected one of {}, found '{}'", names, settings.scenario));
}

Json head_of(const Settings& settings, const Gpu& gpu, int argc, char** argv) {
    std::string command;
    for (int i = 0; i < argc; ++i)
        command += (i ? " " : "") + std::string(argv[i]);
    return {{"scenario", settings.scenario},
            {"device", gpu.info().name},
            {"driver", gpu.info().driver},
            {"commit", ISORAST_COMMIT},
            {"command", command},
            {"quick", settings.quick},
            {"frames", settings.frames},
            {"warm_up", settings.warm_up},
            {"agreement", Json::array()},
            {"skipped", Json::array()},
            {"rows", Json::array()}};
}

// What is drawn, frame by frame: bench/compare_vtk.py has VTK draw the same.
void add_shots(const Subject& subject, const std::vector<Sequence>& sequences, Json& report) {
    for (const Sequence& sequence : sequences) {
        Json shots = Json::array();
        for (const auto& [frame, row] : sequence.shots)
            shots.push_back({{"isovalues", frame.isovalues},
                             {"position", frame.camera.position},
                             {"target", frame.camera.target},
                             {"up", frame.camera.up},
                             {"fov_degrees", frame.camera.fov_degrees}});
        const Size size = sequence.shots.front().frame.size;
        report["shots"].push_back({{"volume", subject.name},
                                   {"sequence", sequence.name},
                                   {"width", size.width},
                                   {"height", size.height},
                                   {"frames", shots}});
    }
}

void measure(Gpu& gpu, const Scenario& scenario, const Settings& settings, const Subject& subject,
             Json& report) {
    Contest contest(gpu, subject, settings, report);
    if (contest.empty()) return;
    std::vector<Sequence> sequences = scenario.sequences(contest, subject, settings);
    std::erase_if(sequences, [&](const Sequence& sequence) {
        return !settings.sequences.empty() &&
               !std::ranges::count(settings.sequences, sequence.name);
    });
    if (settings.shots) add_shots(subject, sequences, report);
    contest.measure(sequences);
}

void write(const Json& report, const std::string& path) {
    if (path.empty()) return;
    std::ofstream file(path);
    if (!(file << report.dump(1) << "\n" << std::flush))
        throw Error(fmt::format("{}: cannot be written", path));
}

}  // namespace

int main(int argc, char** argv) try {
    Settings settings;
    CLI::App app{"GPU times of whole frames and their passes"};
    add_options(app, settings);
    CLI11_PARSE(app, argc, argv);
    const Scenario& scenario = scenario_of(settings);
    settings = with_defaults(settings, scenario);

    Gpu gpu({.device = settings.device});
    Json report = head_of(settings, gpu, argc, argv);
    fmt::print("{}: {}\n{}, {}, commit {}; medians of {} frames in two rounds\n", scenario.name,
               scenario.what, gpu.info().name, gpu.info().driver, ISORAST_COMMIT, settings.frames);
    const auto start = std::chrono::steady_clock::now();
    // What cannot be read or written is said now, not after minutes.
    std::vector<Subject> subjects;
    for (const std::string& volume : settings.volumes)
        subjects.push_back(parse_subject(volume));
    write(report, settings.output);
    for (const Subject& subject : subjects) {
        const size_t first = report["rows"].size();
        try {
            measure(gpu, scenario, settings, subject, report);
        } catch (const Error& error) {
            fmt::print("  left out: {}: {}\n", subject.name, error.what());
            report["skipped"].push_back(
                {{"volume", subject.name}, {"way", ""}, {"why", error.what()}});
        }
        print_tables(report["rows"], first);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        report["seconds"] = seconds.count();
        write(report, settings.output);
    }
    fmt::print("{:.1f} s\n", report["seconds"].get<double>());
    if (report["rows"].empty()) throw Error("nothing could be measured");
    return 0;
} catch (const std::exception& error) {
    fmt::print(stderr, "isorast-bench: error: {}\n", error.what());
    return 1;
}
