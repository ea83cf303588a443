// SPDX-License-Identifier: MIT
// isorast mesh: a volume's isosurfaces as a mesh file.
#include <fmt/format.h>
#include <isorast/mesh.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "frames.h"
#include "options.h"

namespace isorast::cli {
namespace {

using Clock = std::chrono::steady_clock;

struct MeshCommand : Command {
    VolumeArguments arguments;
    GpuOptions gpu_options;
    MeshOptions options;
    std::vector<std::string> isovalue_words;
    std::string output;
    bool stats = false, json = false;

    explicit MeshCommand(CLI::App& parent)
        : Command(*parent.add_subcommand("mesh", "Write isosurfaces as a mesh")) {
        arguments.add_to(app);
        add_isovalues(app, isovalue_words);
        app.add_option("--device", gpu_options.device,
                       "A number or a part of a name from `isorast devices`, or cpu")
            ->type_name("DEVICE")
            ->group("Device");
        app.add_option("--max-brick-side", options.max_brick_side)->group("");  // for tests
        app.add_option("-o,--output", output,
                       "The file: .stl, .ply, .obj or .glb; .obj and .glb hold several isovalues")
            ->type_name("FILE")
            ->required()
            ->check(CLI::Validator(
                [](const std::string& path) { return why_not_writable(path, 1); }, ""))
            ->group("Output");
        app.add_flag("--stats", stats, "Print a line for each surface")->group("Output");
        app.add_flag("--json", json, "Print all of this as JSON")->group("Output");
        app.footer(
            "Examples: isorast mesh head.nrrd --iso 300 -o head.stl\n"
            "          isorast mesh ct.nii.gz --iso 200,600 -o ct.glb");
    }

    int run() override {
        const auto start = Clock::now();
        const Series series = open_series(arguments.inputs, arguments.load);
        const auto steps = parse_steps(series, arguments.time, /* all= */ false);
        if (steps.size() > 1)
            throw CLI::ValidationError("--time", "expected one time step: a file holds one");
        const Volume volume = series.load(steps.front());
        const auto isovalues = isovalues_of(isovalue_words, volume);
        if (const std::string why = why_not_writable(output, isovalues.size()); !why.empty()) {
            throw Error(why);
        }
        if (series.steps > 1 && arguments.time.empty()) {
            note(fmt::format("{}: this is time step {} of 0 to {}; choose with --time", series.name,
                             steps.front(), series.steps - 1));
        }
        Gpu gpu(gpu_options);
        const RendererOptions fitting{.max_brick_side = options.max_brick_side};
        if (const std::string unfit = what_does_not_fit(gpu, volume, fitting); !unfit.empty()) {
            throw Error(unfit);
        }
        const std::vector<Mesh> meshes = extract_meshes(gpu, volume, isovalues, options);
        for (size_t i = 0; i < meshes.size(); ++i) {
            if (!meshes[i].triangles.empty()) continue;
            throw Error(fmt::format(
                "{}: no surface at {:.6g}, so nothing is written; isorast info shows the values",
                volume.name, isovalues[i]));
        }
        write_meshes(output, meshes);
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        report(meshes, isovalues, gpu.info(), seconds);
        return 0;
    }

    void report(const std::vector<Mesh>& meshes, const std::vector<double>& isovalues,
                const DeviceInfo& device, double seconds) const {
        Json surfaces = Json::array();
        uint64_t triangles = 0, vertices = 0;
        std::string lines, values;
        for (size_t i = 0; i < meshes.size(); ++i) {
            const Mesh& mesh = meshes[i];
            triangles += mesh.triangles.size();
            vertices += mesh.positions.size();
            values += fmt::format("{}{:.6g}", i ? ", " : "", isovalues[i]);
            lines += fmt::format("iso {:<12.6g}{:>12} triangles {:>12} vertices  {}\n",
                                 isovalues[i], mesh.triangles.size(), mesh.positions.size(),
                                 mesh.closed ? "closed" : "open at the volume's border");
            surfaces.push_back({{"isovalue", isovalues[i]},
                                {"triangles", mesh.triangles.size()},
                                {"vertices", mesh.positions.size()},
                                {"closed", mesh.closed}});
        }
        std::error_code is_no_file;
        const uint64_t size = std::filesystem::file_size(output, is_no_file);
        const uint64_t bytes = is_no_file ? 0 : size;
        const std::string units = meshes.front().length_units;
        if (json) {
            return print(text_of(Json{{"output", output},
                                      {"bytes", bytes},
                                      {"triangles", triangles},
                                      {"vertices", vertices},
                                      {"surfaces", surfaces},
                                      {"length_units", units},
                                      {"device", device.name},
                                      {"driver", device.driver},
                                      {"seconds", seconds}}));
        }
        print(fmt::format(
            "{}  iso {}  {} triangles  {} vertices  {}  lengths in {}  {}  {:.2f} s\n{}", output,
            values, triangles, vertices, human_bytes(bytes),
            units.empty() ? "unknown units" : units, device.name, seconds, stats ? lines : ""));
    }
};

}  // namespace

std::unique_ptr<Command> make_mesh(CLI::App& parent) {
    return std::make_unique<MeshCommand>(parent);
}

}  // namespace isorast::cli
