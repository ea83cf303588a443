// SPDX-License-Identifier: MIT
// Ways, sizes and volumes from their words.
#include "settings.h"

#include <fmt/format.h>
#include <isorast/error.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "volume/text.h"

namespace isorast::bench {

namespace fs = std::filesystem;

namespace {

// NAME_256x256x128_uint8.raw: the reader for other spellings needs no place here.
Volume map_raw(const std::string& path) {
    Volume volume;
    volume.name = path;
    const std::string stem = fs::path(path).stem().string();
    const auto words = split(stem, "_");
    for (size_t i = 0; i + 1 < words.size(); ++i) {
        const auto sides = split(words[i], "x");
        const auto type = parse_voxel_type(words[i + 1]);
        if (sides.size() != 3 || !type) continue;
        for (int axis = 0; axis < 3; ++axis)
            volume.dims[axis] = parse_number<uint32_t>(sides[axis]).value_or(0);
        volume.type = *type;
    }
    if (!volume.voxel_count())
        fail(path,
             "expected a formula such as head:256:type=u8, or a file that tells its size and "
             "type by its name, such as head_256x256x128_uint8.raw");
    volume.bytes = VoxelBytes::map(path, 0, volume.byte_count());
    check(volume);
    return volume;
}

Series raw_series(const std::string& path) {
    std::vector<std::string> files;
    if (fs::is_directory(path)) {
        for (const auto& entry : fs::directory_iterator(path))
            if (entry.path().extension() == ".raw") files.push_back(entry.path().string());
        std::ranges::sort(files, comes_before);
        if (files.empty()) fail(path, "expected .raw files in this folder, found none");
    } else {
        files.push_back(path);
    }
    const auto steps = uint32_t(files.size());
    return {.name = path, .steps = steps, .load = [files = std::move(files)](uint32_t step) {
                return map_raw(files[step]);
            }};
}

// A number, auto, pNN or Nsigma; else an '@' belongs to a path.
bool is_isovalue(std::string_view word) {
    if (word == "auto") return true;
    if (word.starts_with('p'))
        word.remove_prefix(1);
    else if (word.ends_with("sigma"))
        word.remove_suffix(5);
    return parse_number<double>(word).has_value();
}

}  // namespace

Frame Way::of(Frame frame) const {
    frame.shading = shading;
    frame.culling = culling;
    return frame;
}

Way parse_way(const std::string& words) {
    Way way{.words = words};
    std::istringstream stream(words);
    stream >> way.options.technique;
    for (std::string word; stream >> word;) {
        const auto rasterizer = parse_rasterizer(word);
        const auto occlusion = parse_occlusion(word);
        if (word == "forward")
            way.shading = Shading::forward, way.options.rasterizer = Rasterizer::hardware;
        else if (word == "exact")
            way.options.exact = true;
        else if (word == "unculled")
            way.culling = false;
        else if (rasterizer)
            way.options.rasterizer = *rasterizer;
        else if (occlusion)
            way.options.occlusion = *occlusion;
        else
            throw Error(
                fmt::format("way '{}': expected hardware, compute, forward, exact, raster, "
                            "hiz or unculled, found '{}'",
                            words, word));
    }
    return way;
}

Size parse_size(const std::string& text) {
    const auto sides = split(text, "x");
    const auto width = parse_number<uint32_t>(sides.empty() ? "" : sides.front());
    const auto height = parse_number<uint32_t>(sides.empty() ? "" : sides.back());
    if (sides.size() != 2 || !width || !height)
        throw Error(fmt::format("size: expected WIDTHxHEIGHT, found '{}'", text));
    return {*width, *height};
}

Subject parse_subject(const std::string& text) {
    size_t at = text.rfind('@');
    if (at != text.npos && !is_isovalue(text.substr(at + 1))) at = text.npos;
    Subject subject{.name = text.substr(0, at)};
    subject.series =
        is_procedural(subject.name) ? procedural_series(subject.name) : raw_series(subject.name);
    subject.first = subject.series.load(0);
    const std::string isovalue = at == text.npos ? "auto" : text.substr(at + 1);
    subject.isovalue = parse_isovalues(isovalue, subject.first).front();
    return subject;
}

}  // namespace isorast::bench
