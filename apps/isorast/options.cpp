// SPDX-License-Identifier: MIT
// What the commands share; see options.h.
#include "options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "frames.h"

namespace isorast::cli {
namespace {

template <class T>
std::vector<T> numbers(const std::string& option, const std::string& text, size_t count,
                       bool (*allowed)(T), const char* expected) {
    std::vector<T> found;
    for (const char *at = text.data(), *end = at + text.size();;) {
        T number{};
        const auto [next, error] = std::from_chars(at, end, number);
        if (error != std::errc{} || !allowed(number)) break;
        found.push_back(number);
        if (next == end && found.size() == count) return found;
        if (next == end || (*next != 'x' && *next != ',')) break;
        at = next + 1;
    }
    throw CLI::ValidationError(option, fmt::format("expected {}, found \"{}\"", expected, text));
}

struct NamedColor {
    std::string_view name;
    uint32_t rgb;
};

constexpr NamedColor COLORS[] = {
    {"black", 0x000000},  {"white", 0xffffff},  {"gray", 0x808080},    {"grey", 0x808080},
    {"silver", 0xc0c0c0}, {"red", 0xd62728},    {"green", 0x2ca02c},   {"blue", 0x1f77b4},
    {"yellow", 0xf2c037}, {"orange", 0xff7f0e}, {"purple", 0x9467bd},  {"pink", 0xe377c2},
    {"brown", 0x8c564b},  {"cyan", 0x17becf},   {"magenta", 0xd0309a}, {"bone", 0xe3dac9},
};

Color color_of(uint32_t rgb) {
    const auto channel = [&](int shift) { return static_cast<float>(rgb >> shift & 255) / 255; };
    return {channel(16), channel(8), channel(0), 1};
}

}  // namespace

std::vector<double> parse_numbers(const std::string& option, const std::string& text,
                                  size_t count) {
    const std::string expected =
        count == 3 ? "three numbers like 0.5,0.5,2" : fmt::format("{} numbers", count);
    return numbers<double>(
        option, text, count, [](double value) { return std::isfinite(value); }, expected.c_str());
}

std::vector<uint32_t> parse_counts(const std::string& option, const std::string& text,
                                   size_t count) {
    return numbers<uint32_t>(
        option, text, count, [](uint32_t value) { return value > 0; },
        count == 2 ? "WxH, like 1280x720" : "WxHxD, like 256x256x128");
}

Color parse_color(const std::string& option, const std::string& text) {
    for (const NamedColor& color : COLORS) {
        if (text == color.name) return color_of(color.rgb);
    }
    uint32_t rgb = 0;
    const char* end = text.data() + text.size();
    if (text.starts_with('#') && (text.size() == 4 || text.size() == 7)) {
        const auto [next, error] = std::from_chars(text.data() + 1, end, rgb, 16);
        if (error == std::errc{} && next == end) {
            if (text.size() == 7) return color_of(rgb);
            return color_of((rgb >> 8 & 15) * 0x110000 + (rgb >> 4 & 15) * 0x1100 +
                            (rgb & 15) * 0x11);
        }
    }
    std::string names;
    for (const NamedColor& color : COLORS)
        names += fmt::format(" {}", color.name);
    throw CLI::ValidationError(
        option, fmt::format("expected #rrggbb or one of{}; found \"{}\"", names, text));
}

void VolumeArguments::add_to(CLI::App& app) {
    const auto add = [&](const std::string& name, const std::string& help, const char* type,
                         auto take) {
        app.add_option_function<std::string>(
               name,
               [this, name, take](const std::string& text) {
                   take(text);
                   as_typed += fmt::format(" {} {}", name, shell_word(text));
               },
               help)
            ->type_name(type)
            ->group("Reading");
    };
    app.add_option(
           "INPUT", inputs,
           "A volume file (raw, NRRD, MetaImage, NIfTI) or a formula like sphere:64; several "
           "files or a\ndirectory of them: a time series")
        ->type_name("")
        ->required();
    add("--dims", "Voxels of a raw file, x fastest", "WxHxD", [this](const std::string& text) {
        const auto n = parse_counts("--dims", text, 3);
        load.dims = {n[0], n[1], n[2]};
    });
    add("--type", "Voxel type of a raw file: u8 i8 u16 i16 u32 i32 f32 f64", "TYPE",
        [this](const std::string& text) {
            load.type = parse_voxel_type(text);
            if (!load.type) {
                throw CLI::ValidationError(
                    "--type", "expected u8 i8 u16 i16 u32 i32 f32 or f64, found \"" + text + "\"");
            }
        });
    add("--endian", "Byte order of a raw file", "little|big", [this](const std::string& text) {
        if (text != "little" && text != "big") {
            throw CLI::ValidationError("--endian",
                                       "expected little or big, found \"" + text + "\"");
        }
        load.big_endian = text == "big";
    });
    add("--spacing", "Distance of voxels along x, y, z", "X,Y,Z", [this](const std::string& text) {
        const auto n = parse_numbers("--spacing", text, 3);
        if (!std::ranges::all_of(n, [](double s) { return s > 0; })) {
            throw CLI::ValidationError("--spacing", "must be positive, found \"" + text + "\"");
        }
        load.spacing = {n[0], n[1], n[2]};
    });
    add("--offset", "Bytes to skip at the start of a raw file", "BYTES",
        [this](const std::string& text) {
            const char* end = text.data() + text.size();
            const auto [next, error] = std::from_chars(text.data(), end, load.offset);
            if (error != std::errc{} || next != end) {
                throw CLI::ValidationError("--offset",
                                           "expected a whole number, found \"" + text + "\"");
            }
        });
    add("--time", "Time steps, from 0: one, all, FIRST:LAST or FIRST:LAST:STEP", "STEPS",
        [this](const std::string& text) {
            if (const std::string wrong = check_steps(text); !wrong.empty())
                throw CLI::ValidationError("--time", wrong);
            time = text;
        });
}

void add_isovalues(CLI::App& app, std::vector<std::string>& words) {
    const auto check = [](const std::string& text) {
        // A wrong word is found before a large file is read.
        try {
            parse_isovalues(text, make_procedural("sphere:2"));
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    app.add_option("--iso", words,
                   "Isovalues in data units: 300 | 200,600 | 200:1000:100 | p99 | 1.5sigma | "
                   "auto (default)")
        ->type_name("VALUES")
        ->allow_extra_args(false)
        ->check(CLI::Validator(check, ""))
        ->group("Surface");
}

std::vector<double> isovalues_of(const std::vector<std::string>& words, const Volume& volume) {
    return parse_isovalues(words.empty() ? "auto" : fmt::format("{}", fmt::join(words, ",")),
                           volume);
}

std::string human_bytes(uint64_t bytes) {
    constexpr const char* UNITS[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
    double size = static_cast<double>(bytes);
    size_t unit = 0;
    for (; size >= 999.5 && unit + 1 < std::size(UNITS); ++unit)
        size /= 1024;
    return unit == 0 ? fmt::format("{} bytes", bytes) : fmt::format("{:.3g} {}", size, UNITS[unit]);
}

std::string shell_word(const std::string& text) {
    const bool plain = !text.empty() && std::ranges::all_of(text, [](unsigned char c) {
        return std::isalnum(c) || c >= 128 ||
               std::string_view("_./:=,+-@%").find(char(c)) != std::string_view::npos;
    });
    if (plain) return text;
    std::string quoted = "'";
    for (char c : text)
        quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::string text_of(const Difference& difference, Size size, double tolerance) {
    return fmt::format("max {:g}  rms {:.3g}  {} of {} pixels ({:.3g} %) differ by more than {:g}",
                       difference.maximum, difference.root_mean_square, difference.pixels_over,
                       uint64_t{size.width} * size.height, 100 * difference.share_over, tolerance);
}

Json json_of(const Difference& difference, double tolerance) {
    return {{"max", difference.maximum},
            {"rms", difference.root_mean_square},
            {"pixels_over", difference.pixels_over},
            {"share_over", difference.share_over},
            {"tolerance", tolerance},
            {"same", difference.pixels_over == 0}};
}

std::string text_of(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace isorast::cli
