// SPDX-License-Identifier: MIT
// Raw voxels without a header. Dimensions and type come from the options or from the file's name:
// NAME_256x256x128_uint8.raw, or NAME_256_256_128_1_2.raw with components (1) and bytes per
// component.
#include <filesystem>

#include "volume/formats/data.h"
#include "volume/formats/reader.h"

namespace isorast {
namespace {

struct NamedLayout {
    std::array<uint32_t, 3> dims{};
    std::optional<VoxelType> type;
    uint32_t components = 1;
    std::optional<uint32_t> bytes;  // per component, in the second spelling
};

std::optional<std::array<uint32_t, 3>> parse_dims(const std::vector<std::string_view>& words) {
    std::array<uint32_t, 3> dims{};
    for (size_t axis = 0; axis < 3; ++axis) {
        const auto number = parse_number<uint32_t>(words[axis]);
        if (!number) return std::nullopt;
        dims[axis] = *number;
    }
    return dims;
}

// "..._256x256x128_uint8": the type may be missing.
std::optional<NamedLayout> parse_crossed(const std::vector<std::string_view>& words) {
    for (size_t i = 0; i < words.size(); ++i) {
        const auto sides = split(words[i], "x");
        if (sides.size() != 3 || words[i].find("xx") != std::string_view::npos) continue;
        const auto dims = parse_dims(sides);
        if (!dims) continue;
        NamedLayout layout;
        layout.dims = *dims;
        if (i + 1 < words.size()) layout.type = parse_voxel_type(words[i + 1]);
        return layout;
    }
    return std::nullopt;
}

// "..._256_256_128_1_2"
std::optional<NamedLayout> parse_counted(const std::vector<std::string_view>& words) {
    if (words.size() < 5) return std::nullopt;
    const std::vector<std::string_view> last(words.end() - 5, words.end());
    const auto dims = parse_dims(last);
    const auto components = parse_number<uint32_t>(last[3]),
               bytes = parse_number<uint32_t>(last[4]);
    if (!dims || !components || !bytes) return std::nullopt;
    NamedLayout layout;
    layout.dims = *dims;
    layout.components = *components;
    layout.bytes = bytes;
    if (*bytes == 1) layout.type = VoxelType::u8;
    if (*bytes == 2) layout.type = VoxelType::u16;
    if (*bytes == 4) layout.type = VoxelType::f32;
    return layout;
}

std::optional<NamedLayout> parse_name(const std::string& path) {
    const std::string stem = std::filesystem::path(path).stem().string();
    const auto words = split(stem, "_");
    if (const auto layout = parse_crossed(words)) return layout;
    return parse_counted(words);
}

}  // namespace

bool is_raw_name(const std::string& path) {
    return parse_name(path).has_value();
}

OpenedFile open_raw(const std::string& path, const LoadOptions& options) {
    Volume volume;
    volume.name = path;
    const NamedLayout named = parse_name(path).value_or(NamedLayout{});
    volume.dims = options.dims.value_or(named.dims);
    if (volume.dims == std::array<uint32_t, 3>{})
        fail(path,
             "raw voxels need dimensions and a type: in the name, as in head_256x256x128_uint8.raw "
             "or "
             "head_256_256_128_1_1.raw, or as options");
    if (!options.dims && named.components != 1)
        fail(path, "the name gives {} components per voxel; only volumes with one can be read",
             named.components);
    const auto type = options.type ? options.type : named.type;
    if (!type && named.bytes)
        fail(path,
             "the name gives {} bytes per component; expected 1 (u8), 2 (u16) or 4 (f32), or the "
             "type "
             "as an option",
             *named.bytes);
    if (!type)
        fail(path,
             "raw voxels need a type (u8 i8 u16 i16 u32 i32 f32 f64), in the name after the "
             "dimensions or as an option");
    volume.type = *type;
    set_time(volume, 1, options);
    return {std::move(volume),
            {.files = {path},
             .big_endian = options.big_endian.value_or(false),
             .offset = options.offset}};
}

}  // namespace isorast
