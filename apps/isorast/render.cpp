// SPDX-License-Identifier: MIT
// isorast render: pictures of a volume's isosurfaces, one or one for each time step.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "frames.h"
#include "pictures.h"
#include "report.h"
#include "view.h"

namespace isorast::cli {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<std::string> with_automatic(std::vector<std::string> names) {
    names.insert(names.begin(), "auto");
    return names;
}

struct Render : Command {
    VolumeArguments arguments;
    ViewArguments view;
    RendererOptions options;
    GpuOptions gpu_options;
    Frame frame;
    std::vector<std::string> isovalue_words;
    std::string output, reference;
    std::vector<uint32_t> steps;                   // of the series
    std::vector<std::string> outputs, references;  // the pictures of these
    bool transparent = false, stats = false, json = false;
    double tolerance = 0;
    size_t repeat = 1;
    bool all_empty = true;  // each of the pictures

    explicit Render(CLI::App& parent)
        : Command(*parent.add_subcommand("render", "Render isosurfaces to PNG files")) {
        arguments.add_to(app);
        add_surface_options();
        add_picture_options();
        view.add_to(app);
        add_device_options();
        add_output_options();
        app.footer(
            "Examples: isorast render head.nrrd --iso 300 -o head.png\n"
            "          isorast render ct.nii.gz --iso 200,600 --color bone,red --view A --size "
            "1920x1080\n"
            "          isorast render run/ --time all -o frame_{frame:4}.png");
    }

    void add_surface_options() {
        add_isovalues(app, isovalue_words);
        app.add_option_function<std::vector<std::string>>(
               "--color",
               [this](const std::vector<std::string>& words) {
                   for (const std::string& word : words)
                       frame.colors.push_back(parse_color("--color", word));
               },
               "A color for each isovalue: names or #rrggbb; default: a palette")
            ->type_name("COLORS")
            ->delimiter(',')
            ->allow_extra_args(false)
            ->group("Surface");
        add_word("--shading", "gooch (default), phong, normals, depth, blocks or forward",
                 "Surface", frame.shading, parse_shading);
        app.add_option("--technique", options.technique,
                       fmt::format("{}", fmt::join(with_automatic(techniques()), ", ")))
            ->type_name("NAME")
            ->capture_default_str()
            ->check(CLI::IsMember(with_automatic(techniques())).description(""))
            ->group("Surface");
        add_word("--rasterizer", "auto (default), hardware or compute", "Surface",
                 options.rasterizer, parse_rasterizer);
        app.add_flag("--exact", options.exact,
                     "raymarch: solve each cell's cubic instead of stepping")
            ->group("Surface");
        app.add_option_function<std::string>(
               "--culling",
               [this](const std::string& word) {
                   frame.culling = word != "off";
                   if (frame.culling) options.occlusion = parse_occlusion(word).value();
               },
               "Skip what is out of view or hidden: auto (default), by raster proxies, by a depth "
               "pyramid (hiz), or off")
            ->type_name("auto|raster|hiz|off")
            ->check(CLI::IsMember({"auto", "raster", "hiz", "off"}).description(""))
            ->group("Surface");
    }

    template <class Value, class Parse>
    void add_word(const std::string& name, const std::string& words, const std::string& group,
                  Value& value, Parse parse) {
        app.add_option_function<std::string>(
               name,
               [name, words, parse, &value](const std::string& word) {
                   const auto parsed = parse(word);
                   if (!parsed) {
                       throw CLI::ValidationError(
                           name, fmt::format("expected {}; found \"{}\"", words, word));
                   }
                   value = *parsed;
               },
               words)
            ->type_name("NAME")
            ->group(group);
    }

    void add_picture_options() {
        app.add_option_function<std::string>(
               "--size",
               [this](const std::string& text) {
                   const auto n = parse_counts("--size", text, 2);
                   frame.size = {n[0], n[1]};
               },
               "Pixels of the picture; default 1280x720")
            ->type_name("WxH")
            ->group("Picture");
        app.add_option_function<std::string>(
               "--background",
               [this](const std::string& text) {
                   frame.background = parse_color("--background", text);
               },
               "Color behind the surface: a name or #rrggbb; default white")
            ->type_name("COLOR")
            ->group("Picture");
        app.add_flag("--transparent", transparent, "No background: alpha 0")->group("Picture");
    }

    void add_device_options() {
        app.add_option("--device", gpu_options.device,
                       "A number or a part of a name from `isorast devices`, or cpu")
            ->type_name("DEVICE")
            ->group("Device");
        app.add_flag("--validation", gpu_options.validation,
                     "Turn the Vulkan validation layer on; any message makes the exit code 1")
            ->group("Device");
        app.add_option("--max-brick-side", options.max_brick_side)->group("");  // for tests
    }

    void add_output_options() {
        app.add_option(
               "-o,--output", output,
               "The PNG file, - for standard output; default: INPUT's name in this folder.\n"
               "{frame:4} counts the pictures of a series, {time:4} is the time step")
            ->type_name("FILE")
            ->check(CLI::Validator(
                [](const std::string& path) {
                    const std::string ending = std::filesystem::path(path).extension().string();
                    const bool png = ending.empty() || ending == ".png" || ending == ".PNG";
                    return png ? std::string() : "only .png files can be written, found " + path;
                },
                ""))
            ->group("Output");
        CLI::Option* compared =
            app.add_option(
                   "--reference", reference,
                   "Compare with this PNG; where it differs, write NAME.difference.png and exit 1")
                ->type_name("FILE")
                ->group("Output");
        app.add_option("--tolerance", tolerance, "Allowed difference of a channel, 0 to 255")
            ->type_name("T")
            ->check(CLI::Range(0.0, 255.0).description(""))
            ->needs(compared)
            ->group("Output");
        app.add_flag("--stats", stats, "Print the GPU time of each pass, block counts and bytes")
            ->group("Output");
        app.add_flag("--json", json, "Print all of this as JSON")->group("Output");
        app.add_option("--repeat", repeat,
                       "Render N frames after one for warming up; --stats gives medians")
            ->type_name("N")
            ->check(CLI::Range(size_t{1}, size_t{100000}).description(""))
            ->group("Output");
    }

    int run() override {
        const auto start = Clock::now();
        if (output == "-" && json) {
            throw CLI::ValidationError("--json",
                                       "standard output takes the picture; name a file with -o");
        }
        if (view.stereo.mode == StereoMode::layers && (output == "-" || !reference.empty()))
            throw CLI::ValidationError("--stereo",
                                       "layers makes two files: name them with -o, and "
                                       "compare them with isorast compare");
        if (transparent) frame.background.a = 0;

        const Series series = open_series(arguments.inputs, arguments.load);
        steps = parse_steps(series, arguments.time, names_frames(output));
        if (output.empty()) output = default_output(arguments.inputs.front(), steps.size() > 1);
        outputs = picture_names("--output", output, steps);
        if (!reference.empty()) references = picture_names("--reference", reference, steps);
        const Volume volume = series.load(steps.front());
        frame.isovalues = isovalues_of(isovalue_words, volume);
        if (frame.colors.size() > frame.isovalues.size()) {
            throw CLI::ValidationError(
                "--color", fmt::format("{} colors for {} isovalues", frame.colors.size(),
                                       frame.isovalues.size()));
        }
        frame.clips = view.clip_planes(volume);
        frame.stereo = view.stereo;
        view.camera(volume, {});  // a side that this volume does not have is said at once
        note_what_is_special(volume);

        // Only mesh shaders make normals.
        if (frame.shading == Shading::forward && options.rasterizer == Rasterizer::automatic)
            options.rasterizer = Rasterizer::hardware;
        Gpu gpu(gpu_options);
        if (const std::string unfit =
                what_does_not_fit(gpu, volume, options, uint32_t(steps.size()));
            !unfit.empty()) {
            throw Error(unfit);
        }
        Renderer renderer(gpu, chosen_steps(series, steps, volume), options);
        note_isovalues_outside(volume.name, renderer.value_range());
        const bool chosen = options.technique == "auto" || options.technique == "direct";
        if (options.rasterizer == Rasterizer::automatic && chosen) {
            const std::string problem = choose_rasterizer(gpu, volume.type).problem;
            if (!problem.empty())
                note(
                    fmt::format("{}: the compute rasterizer fails its self-test ({}): {} with the "
                                "{} rasterizer instead",
                                gpu.info().name, problem, renderer.technique(),
                                name_of(renderer.rasterizer())));
        }
        // One camera for all steps: none of them can leave the volume's box.
        frame.camera = view.camera(
            volume, steps.size() > 1 ? VoxelPoints{} : renderer.surface_hull(frame.isovalues));

        RenderReport report{.outputs = {},
                            .time_steps = steps,
                            .size = {},
                            .isovalues = frame.isovalues,
                            .technique = renderer.technique(),
                            .rasterizer = std::string(name_of(renderer.rasterizer())),
                            .culling = culling_of(renderer),
                            .device = gpu.info().name,
                            .driver = gpu.info().driver,
                            .value_range = renderer.value_range(),
                            .difference = std::nullopt,
                            .tolerance = tolerance};
        render_all(renderer, volume.name, report);
        report.seconds = seconds_since(start);
        if (all_empty) note_what_hides(volume, renderer.value_range());
        print(report);
        const bool differs = report.difference && report.difference->pixels_over > 0;
        return print_validation(gpu) || differs ? 1 : 0;
    }

    // Every time step, `repeat` times; the last round is written.
    void render_all(Renderer& renderer, const std::string& source, RenderReport& report) {
        const size_t rounds = repeat > 1 ? repeat + 1 : 1;  // the first one warms up
        Progress progress(rounds * steps.size());
        std::vector<FrameStats> all_stats;
        for (size_t round = 0; round < rounds; ++round) {
            for (size_t i = 0; i < steps.size(); ++i) {
                frame.time_step = static_cast<uint32_t>(i);
                const Image image = renderer.render(frame);
                if (round > 0 || rounds == 1) all_stats.push_back(renderer.stats());
                if (round + 1 == rounds) {
                    all_empty = all_empty &&
                                shows_only_background(image, frame.background,
                                                      view.stereo.mode == StereoMode::anaglyph);
                    write(image, i, source, report);
                    if (!reference.empty()) compare_with_reference(image, i, report);
                }
                progress.done();
            }
        }
        report.frames = all_stats.size();
        report.stats = median_of(all_stats);
        for (const FrameStats& stats_of_frame : all_stats)
            report.longest_wait_ms = std::max(report.longest_wait_ms, stats_of_frame.wait_ms);
    }

    std::string culling_of(const Renderer& renderer) const {
        if (!frame.culling) return "off";
        const Occlusion occlusion = renderer.occlusion();
        return occlusion == Occlusion::automatic ? "none" : std::string(name_of(occlusion));
    }

    // What makes a picture empty, or another one than expected, is said before it is made.
    void note_what_is_special(const Volume& volume) const {
        for (int axis = 0; axis < 3; ++axis) {
            if (volume.dims[axis] > 1) continue;
            note(fmt::format("{}: 1 voxel thin along {}: no cells, so only background", volume.name,
                             "xyz"[axis]));
        }
        if (volume.time_steps > 1 && steps.size() == 1 && arguments.time.empty()) {
            note(fmt::format("{}: this is time step {} of 0 to {}; choose with --time", volume.name,
                             volume.time_step, volume.time_steps - 1));
        }
    }

    void note_isovalues_outside(const std::string& name, const std::array<double, 2>& range) const {
        if (!(range[0] <= range[1])) {
            return note(fmt::format("{}: no voxel is finite, so only background", name));
        }
        for (double isovalue : frame.isovalues) {
            if (has_surface(isovalue, range)) continue;
            note(fmt::format("{}: no surface at {:.6g}: the values go from {:.6g} to {:.6g}", name,
                             isovalue, range[0], range[1]));
        }
    }

    // Inside is value >= isovalue: at the minimum everything is inside.
    static bool has_surface(double isovalue, const std::array<double, 2>& range) {
        return isovalue > range[0] && isovalue <= range[1];
    }

    // Pictures are empty though the other notes give no reason.
    void note_what_hides(const Volume& volume, const std::array<double, 2>& range) const {
        const bool thin = std::ranges::find(volume.dims, 1u) != volume.dims.end();
        const bool surface = std::ranges::any_of(
            frame.isovalues, [&](double isovalue) { return has_surface(isovalue, range); });
        if (thin || !surface) return;
        note(fmt::format("{}: only background: {}", volume.name,
                         frame.clips.empty() ? "the camera sees no surface"
                                             : "--clip leaves nothing that the camera sees"));
    }

    // The report says what was written, and how large it is.
    void write(const Image& image, size_t index, const std::string& source,
               RenderReport& report) const {
        std::string comment = fmt::format("isovalue {:.9g}", fmt::join(frame.isovalues, ", "));
        if (steps.size() > 1) comment += fmt::format(", time step {}", steps[index]);
        const Written written =
            write_picture(image, outputs[index], view.stereo.mode == StereoMode::layers,
                          {{"Software", "isorast"},
                           {"Source", std::filesystem::path(source).filename().string()},
                           {"Comment", comment}});
        report.outputs.insert(report.outputs.end(), written.files.begin(), written.files.end());
        report.size = written.size;
    }

    // The report keeps the worst difference.
    void compare_with_reference(const Image& image, size_t index, RenderReport& report) const {
        const Image expected = read_png(references[index]);
        const Difference difference = compare(image, expected, tolerance);
        if (!report.difference || difference.pixels_over > report.difference->pixels_over)
            report.difference = difference;
        if (difference.pixels_over == 0) return;
        const std::string path = difference_path(
            output == "-" ? default_output(arguments.inputs.front(), false) : outputs[index]);
        write_png(path, difference_picture(image, expected, tolerance));
        print_error(fmt::format("{} differs: {}; see {}", references[index],
                                text_of(difference, image.size, tolerance), path));
    }

    void print(const RenderReport& report) const {
        const std::string text = json ? text_of(cli::json_of(report))
                                      : summary(report) + (stats ? stats_table(report) : "");
        if (output == "-")
            print_message(text);
        else
            cli::print(text);
    }

    static bool print_validation(const Gpu& gpu) {
        const auto messages = gpu.validation_messages();
        for (const std::string& message : messages)
            print_error("validation: " + message);
        return !messages.empty();
    }
};

}  // namespace

std::unique_ptr<Command> make_render(CLI::App& parent) {
    return std::make_unique<Render>(parent);
}

}  // namespace isorast::cli
