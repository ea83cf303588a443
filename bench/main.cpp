// SPDX-License-Identifier: MIT
// isorast-bench: GPU times of whole frames and their passes, as a table and as JSON. It links the
// core only, so that a binary built on one machine runs on another that has a Vulkan driver and
// little else.
//
//   isorast-bench frames --sides 256,512 --types u8,u16 --fields coral,noise -o frames.json
#include <fmt/format.h>
#include <isorast/camera.h>
#include <isorast/error.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "image/state.h"

namespace {

using namespace isorast;
using Json = nlohmann::ordered_json;

struct Settings {
    std::vector<uint32_t> sides{256};
    std::vector<std::string> types{"u8"}, fields{"coral", "noise"};
    std::vector<std::string> ways{"direct", "direct forward", "raymarch compute",
                                  "raymarch hardware"};
    uint32_t width = 3840, height = 2160, warm_up = 10, frames = 40;
    double azimuth = 30, elevation = 20, zoom = 1;
    std::string device, output;
};

// A technique with its rasterizer, in the words of the tables: "direct forward", "raymarch compute
// exact".
struct Way {
    RendererOptions options;
    Shading shading = Shading::gooch;
};

Way parse_way(const std::string& words) {
    Way way;
    std::istringstream stream(words);
    stream >> way.options.technique;
    for (std::string word; stream >> word;) {
        if (word == "forward")
            way.shading = Shading::forward, way.options.rasterizer = Rasterizer::hardware;
        else if (word == "exact")
            way.options.exact = true;
        else if (const auto rasterizer = parse_rasterizer(word))
            way.options.rasterizer = *rasterizer;
        else
            throw Error(fmt::format(
                "way '{}': expected forward, exact, hardware or compute, found '{}'", words, word));
    }
    return way;
}

double quantile(std::vector<double> values, double share) {
    std::ranges::sort(values);
    return values.empty()
               ? 0
               : values[std::min(values.size() - 1, size_t(share * double(values.size())))];
}

Json summary(const std::vector<double>& values) {
    return {{"median_ms", quantile(values, 0.5)}, {"p95_ms", quantile(values, 0.95)}};
}

// Median and 95th percentile of each pass, and of the whole frame from its first to its last
// timestamp.
Json summarize(const std::vector<std::vector<gpu::TimedPass>>& frames) {
    std::vector<std::string> order;
    std::map<std::string, std::vector<double>> passes;
    std::vector<double> totals;
    for (const auto& frame : frames) {
        for (const gpu::TimedPass& pass : frame) {
            if (!passes.contains(pass.name)) order.push_back(pass.name);
            passes[pass.name].push_back(pass.end_ms - pass.begin_ms);
        }
        totals.push_back(frame.empty() ? 0 : frame.back().end_ms);
    }
    Json json{{"frame", summary(totals)}, {"passes", Json::object()}};
    for (const std::string& name : order)
        json["passes"][name] = summary(passes[name]);
    return json;
}

Json measure(Renderer& renderer, const Frame& frame, const Settings& settings) {
    renderer.render(frame);  // counts, and targets made
    renderer.state().run(std::vector<Frame>(settings.warm_up, frame));
    Json json = summarize(renderer.state().run(std::vector<Frame>(settings.frames, frame)));
    const FrameStats& stats = renderer.stats();
    json["blocks"] = stats.blocks;
    json["blocks_active"] = stats.blocks_active;
    json["blocks_drawn"] = stats.blocks_drawn;
    json["volume_bytes"] = stats.volume_bytes;
    json["extra_bytes"] = stats.extra_bytes;
    return json;
}

void print_row(const std::string& volume, const std::string& way, const Json& json) {
    std::string line = fmt::format("{:<22} {:<26} {:9.3f} ms  p95 {:9.3f}  ", volume, way,
                                   json["frame"]["median_ms"].get<double>(),
                                   json["frame"]["p95_ms"].get<double>());
    for (const auto& [name, pass] : json["passes"].items())
        line += fmt::format("  {} {:.3f}", name, pass["median_ms"].get<double>());
    fmt::print("{}   drawn {}  extra {:.2f} %\n", line, json["blocks_drawn"].get<uint64_t>(),
               100 * json["extra_bytes"].get<double>() / json["volume_bytes"].get<double>());
    std::fflush(stdout);
}

Json frames(Gpu& gpu, const Settings& settings) {
    Json rows = Json::array();
    for (uint32_t side : settings.sides)
        for (const std::string& field : settings.fields)
            for (const std::string& type : settings.types) {
                const std::string name = fmt::format("{}:{}:type={}", field, side, type);
                const Volume volume = make_procedural(name);
                Frame frame{.isovalues = {0.5},
                            .camera = orbit(volume, settings.azimuth, settings.elevation,
                                            {.zoom = settings.zoom}),
                            .size = {settings.width, settings.height}};
                for (const std::string& words : settings.ways) {
                    const Way way = parse_way(words);
                    Renderer renderer(gpu, volume, way.options);
                    frame.shading = way.shading;
                    Json row{{"volume", name}, {"way", words}};
                    row.update(measure(renderer, frame, settings));
                    print_row(name, words, row);
                    rows.push_back(row);
                }
            }
    return rows;
}

}  // namespace

int main(int argc, char** argv) try {
    Settings settings;
    CLI::App app{"GPU times of whole frames and their passes"};
    app.require_subcommand(1);
    auto* command =
        app.add_subcommand("frames", "a still picture, for each volume and way to render");
    command->add_option("--sides", settings.sides, "voxels a side")->delimiter(',');
    command->add_option("--types", settings.types, "u8, u16, f32")->delimiter(',');
    command->add_option("--fields", settings.fields, "formulas")->delimiter(',');
    command
        ->add_option("--ways", settings.ways, "e.g. 'direct,direct forward,raymarch compute exact'")
        ->delimiter(',');
    command->add_option("--width", settings.width);
    command->add_option("--height", settings.height);
    command->add_option("--frames", settings.frames, "counted frames");
    command->add_option("--warm-up", settings.warm_up, "frames before, not counted");
    command->add_option("--azimuth", settings.azimuth);
    command->add_option("--elevation", settings.elevation);
    command->add_option("--zoom", settings.zoom);
    command->add_option("--device", settings.device, "as for isorast render");
    command->add_option("-o,--output", settings.output, "JSON file");
    CLI11_PARSE(app, argc, argv);

    Gpu gpu({.device = settings.device});
    fmt::print("{}, {}, {}x{}, median of {} frames after {}\n", gpu.info().name, gpu.info().driver,
               settings.width, settings.height, settings.frames, settings.warm_up);
    Json json{{"device", gpu.info().name}, {"driver", gpu.info().driver},
              {"width", settings.width},   {"height", settings.height},
              {"frames", settings.frames}, {"warm_up", settings.warm_up}};
    json["command"] = [&] {
        std::string line;
        for (int i = 0; i < argc; ++i)
            line += (i ? " " : "") + std::string(argv[i]);
        return line;
    }();
    json["rows"] = frames(gpu, settings);
    if (!settings.output.empty()) std::ofstream(settings.output) << json.dump(1) << "\n";
    return 0;
} catch (const std::exception& error) {
    fmt::print(stderr, "isorast-bench: error: {}\n", error.what());
    return 1;
}
