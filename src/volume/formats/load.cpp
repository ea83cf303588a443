// SPDX-License-Identifier: MIT
// The table of readers, and which of them takes a file: by the name's ending, else by the first
// bytes.
#include <isorast/load.h>

#include <algorithm>

#include "volume/formats/data.h"
#include "volume/formats/reader.h"

namespace isorast {
namespace {

struct Reader {
    std::string_view name;
    std::vector<std::string_view> endings;  // lower case
    std::string_view magic;                 // first bytes; empty: none are typical
    OpenedFile (*open)(const std::string&, const LoadOptions&);
};

// Tried in this order.
std::vector<Reader> readers() {
    return {
        {"NRRD", {".nrrd", ".nhdr"}, "NRRD000", open_nrrd},
        {"MetaImage", {".mha", ".mhd"}, "ObjectType", open_metaimage},
        {"NIfTI", {".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"}, "", open_nifti},
        {"raw", {".raw"}, "", open_raw},
    };
}

Reader reader_for(const std::string& path, const LoadOptions& options) {
    const auto table = readers();
    const std::string_view format = format_of_ending(path);
    for (const Reader& reader : table)
        if (reader.name == format) return reader;
    if (options.dims || is_raw_name(path)) return {"raw", {}, "", open_raw};
    const VoxelBytes start = VoxelBytes::map(path, 0, std::min<uint64_t>(file_size(path), 16));
    const std::string_view first(reinterpret_cast<const char*>(start.span().data()),
                                 start.span().size());
    for (const Reader& reader : table)
        if (!reader.magic.empty() && first.starts_with(reader.magic)) return reader;
    fail(path,
         "unknown format; isorast reads {}, and any file as raw voxels when dimensions and type "
         "are given",
         known_formats());
}

// Keeps the axes' directions. An axis without one (length 0, or not finite) takes that of the world
// axis.
void set_spacing(Volume& volume, std::array<double, 3> spacing) {
    const auto lengths = volume.affine.spacing();
    for (int axis = 0; axis < 3; ++axis) {
        if (!(spacing[axis] > 0) || !std::isfinite(spacing[axis]))
            fail(volume.name, "spacing must be positive, found {}", spacing[axis]);
        for (int row = 0; row < 3; ++row) {
            double& entry = volume.affine.m[row][axis];
            if (lengths[axis] > 0 && std::isfinite(lengths[axis]))
                entry *= spacing[axis] / lengths[axis];
            else
                entry = row == axis ? spacing[axis] : 0;
        }
    }
}

Volume load_formula(const std::string& name, const LoadOptions& options) {
    if (options.dims || options.type || options.big_endian || options.offset || options.spacing)
        fail(name,
             "a formula takes all its options in its name, as in sphere:64:type=f32:spacing=1,1,2");
    return make_procedural(name, options.time_step);
}

void refuse_raw_options(const Reader& reader, const std::string& path, const LoadOptions& options) {
    if (reader.open != open_raw && (options.dims || options.type || options.offset != 0))
        fail(path, "dimensions, type and offset are options for raw files; {} files give their own",
             reader.name);
}

}  // namespace

std::string known_formats() {
    std::string text;
    for (const Reader& reader : readers())
        text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", reader.name,
                            fmt::join(reader.endings, " "));
    return text;
}

std::string_view format_of_ending(const std::string& path) {
    const std::string lower = lowercase(path);
    for (const Reader& reader : readers())
        for (const std::string_view ending : reader.endings)
            if (lower.ends_with(ending)) return reader.name;
    return {};
}

OpenedFile open_file(const std::string& path, const LoadOptions& options) {
    try {
        file_size(path);
    } catch (const Error& error) {
        throw Error(fmt::format("{}; isorast reads {}", error.what(), known_formats()));
    }
    const Reader reader = reader_for(path, options);
    refuse_raw_options(reader, path, options);
    OpenedFile file = reader.open(path, options);
    if (options.spacing) set_spacing(file.volume, *options.spacing);
    return file;
}

Volume load_volume(const std::string& path, const LoadOptions& options) {
    if (is_procedural(path)) return load_formula(path, options);
    OpenedFile file = open_file(path, options);
    read_voxels(file.volume, file.source);
    check(file.volume);
    return std::move(file.volume);
}

}  // namespace isorast
