// SPDX-License-Identifier: MIT
// Time series: the steps of one file, or several files, a step each.
#include <algorithm>
#include <filesystem>
#include <map>

#include "volume/formats/reader.h"
#include "volume/text.h"

namespace isorast {
namespace {

namespace fs = std::filesystem;

bool ends_with_any(const std::string& path, std::initializer_list<std::string_view> endings) {
    const std::string lower = lowercase(path);
    return std::ranges::any_of(endings,
                               [&](std::string_view ending) { return lower.ends_with(ending); });
}

// The volume files of a folder, sorted. Where some are headers, the data files beside them are
// theirs.
std::vector<std::string> volume_files(const std::string& folder) {
    std::vector<std::string> paths;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const std::string name = at->path().filename().string();
        if (name.starts_with('.') || !at->is_regular_file()) continue;
        if (!format_of_ending(name).empty()) paths.push_back(at->path().string());
    }
    if (error) fail(folder, "cannot be read: {}", error.message());
    const auto is_header = [](const std::string& path) {
        return ends_with_any(path, {".nhdr", ".mhd", ".hdr", ".hdr.gz"});
    };
    if (std::ranges::any_of(paths, is_header))
        std::erase_if(paths, [](const std::string& path) {
            return ends_with_any(path, {".raw", ".img", ".img.gz"});
        });
    if (paths.empty())
        fail(folder, "this directory holds no volume file; isorast reads {}", known_formats());
    std::map<std::string_view, size_t> formats;
    for (const std::string& path : paths)
        ++formats[format_of_ending(path)];
    if (formats.size() > 1) {
        std::string found;
        for (const auto& [format, count] : formats)
            found += fmt::format("{}{} {}", found.empty() ? "" : " and ", count, format);
        fail(folder, "expected volume files of one format, found {}; name the files", found);
    }
    std::ranges::sort(paths, comes_before);
    return paths;
}

Series steps_of_file(const std::string& path, const LoadOptions& options) {
    if (is_procedural(path)) {
        load_volume(path, options);  // or throws for options that formulas do not take
        return procedural_series(path);
    }
    const OpenedFile file = open_file(path, options);
    return {.name = path,
            .steps = file.volume.time_steps,
            .load = StepReader(file.volume, file.source)};
}

Volume header_at(const std::string& path, const LoadOptions& options) {
    return is_procedural(path) ? load_volume(path, options) : open_file(path, options).volume;
}

Series step_in_each_file(std::string name, const std::vector<std::string>& paths,
                         const LoadOptions& options) {
    const Volume first = header_at(paths[0], options);
    for (const std::string& path : paths) {
        const Volume header = header_at(path, options);
        if (header.time_steps > 1)
            fail(path, "expected one time step in each of {} files, found {} in this one",
                 paths.size(), header.time_steps);
        check_step(header, first);
    }
    const auto count = static_cast<uint32_t>(paths.size());
    return {.name = std::move(name), .steps = count, .load = [paths, options](uint32_t step) {
                Volume volume = load_volume(paths[step], options);
                volume.time_steps = static_cast<uint32_t>(paths.size());
                volume.time_step = step;
                return volume;
            }};
}

}  // namespace

Series open_series(const std::vector<std::string>& paths, const LoadOptions& options) {
    if (paths.empty()) throw Error("series: expected a file, a directory or a formula, found none");
    LoadOptions from_start = options;
    from_start.time_step = 0;
    std::error_code error;
    const bool folder = paths.size() == 1 && fs::is_directory(paths[0], error);
    const std::vector<std::string> files = folder ? volume_files(paths[0]) : paths;
    if (files.size() == 1) return steps_of_file(files[0], from_start);
    return step_in_each_file(
        folder ? paths[0] : fmt::format("{} to {}", files.front(), files.back()), files,
        from_start);
}

}  // namespace isorast
