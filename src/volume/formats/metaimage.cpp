// SPDX-License-Identifier: MIT
// MetaImage (.mha: header and voxels in one file; .mhd: voxels in others), as ITK writes and reads
// it. Rows of TransformMatrix are the directions of i, j, k. The world is LPS where
// AnatomicalOrientation says that the file is anatomical; it is turned into RAS.
#include <map>

#include "volume/formats/data.h"
#include "volume/formats/reader.h"
#include "volume/voxels.h"

namespace isorast {
namespace {

struct MetaHeader {
    std::string path;
    std::map<std::string, std::string, std::less<>> fields;
    std::vector<std::string> files;
    uint64_t data_offset = 0;
    bool local = false;

    // The value of the first of these names that is given.
    std::optional<std::string_view> optional(std::initializer_list<std::string_view> names) const {
        for (const std::string_view name : names)
            if (const auto found = fields.find(name); found != fields.end()) return found->second;
        return std::nullopt;
    }
    std::string_view required(std::string_view name) const {
        const auto value = optional({name});
        if (!value || value->empty()) fail(path, "the MetaImage header does not give \"{}\"", name);
        return *value;
    }
    bool flag(std::initializer_list<std::string_view> names, bool otherwise) const {
        const auto value = optional(names);
        if (!value || value->empty()) return otherwise;
        return (*value)[0] == 'T' || (*value)[0] == 't' || (*value)[0] == '1';
    }
};

// "LOCAL", "LIST", "LIST 2", "slice%03d.raw 1 100 1" or a plain name.
void set_files(MetaHeader& header, std::string_view value, Lines& lines) {
    const auto words = split(value);
    if (lowercase(value) == "local") {
        header.local = true;
        header.files = {header.path};
        header.data_offset = lines.consumed();
    } else if (!words.empty() && words[0] == "LIST") {
        header.files = listed_files(header.path, lines);
    } else if (words.size() > 2 && words[0].find('%') != std::string_view::npos) {
        header.files = numbered_files(header.path, words);
    } else {
        header.files = {beside(header.path, value)};
    }
}

MetaHeader parse_header(const std::string& path, std::string_view text) {
    MetaHeader header{.path = path, .fields = {}, .files = {}};
    Lines lines(text);
    while (const auto line = lines.next()) {
        if (trimmed(*line).empty()) continue;
        // ITK takes a colon for an equals sign.
        size_t separator = line->find('=');
        if (separator == std::string_view::npos) separator = line->find(':');
        if (separator == std::string_view::npos)
            fail(path, "expected \"Name = value\" in the MetaImage header, found {}",
                 quoted(*line));
        const std::string_view name = trimmed(line->substr(0, separator)),
                               value = trimmed(line->substr(separator + 1));
        if (!header.fields.emplace(name, value).second)
            fail(path, "the MetaImage header gives {} twice", quoted(name));
        if (name == "ElementDataFile") {
            set_files(header, header.required("ElementDataFile"), lines);
            return header;
        }
    }
    fail(path, "the MetaImage header does not end with \"ElementDataFile\"");
}

VoxelType voxel_type(const MetaHeader& header) {
    const std::string_view word = header.required("ElementType");
    const std::pair<std::string_view, VoxelType> types[] = {
        {"MET_UCHAR", VoxelType::u8},   {"MET_CHAR", VoxelType::i8},
        {"MET_USHORT", VoxelType::u16}, {"MET_SHORT", VoxelType::i16},
        {"MET_UINT", VoxelType::u32},   {"MET_INT", VoxelType::i32},
        {"MET_ULONG", VoxelType::u32},  {"MET_LONG", VoxelType::i32},
        {"MET_FLOAT", VoxelType::f32},  {"MET_DOUBLE", VoxelType::f64},
    };
    for (const auto& [name, type] : types)
        if (word == name) return type;
    fail(header.path,
         "expected a scalar ElementType (MET_UCHAR CHAR USHORT SHORT UINT INT FLOAT DOUBLE), "
         "found {}",
         quoted(word));
}

// `count` numbers, or nothing when none of the names is given.
std::vector<double> numbers(const MetaHeader& header, std::initializer_list<std::string_view> names,
                            size_t count) {
    const auto text = header.optional(names);
    if (!text) return {};
    const auto words = split(*text);
    if (words.size() != count)
        fail(header.path, "{}: expected {} numbers, found {}", *names.begin(), count, words.size());
    std::vector<double> values;
    for (const std::string_view word : words) {
        const auto value = parse_number<double>(word);
        if (!value || !std::isfinite(*value))
            fail(header.path, "{}: expected a finite number, found {}", *names.begin(),
                 quoted(word));
        values.push_back(*value);
    }
    return values;
}

void set_dims(Volume& volume, const MetaHeader& header, size_t dimension,
              const LoadOptions& options) {
    const auto words = split(header.required("DimSize"));
    if (words.size() != dimension)
        fail(header.path, "DimSize: expected {} numbers, found {}", dimension, words.size());
    uint32_t sizes[4] = {1, 1, 1, 1};
    for (size_t axis = 0; axis < dimension; ++axis) {
        const auto size = parse_number<uint32_t>(words[axis]);
        if (!size || *size == 0)
            fail(header.path, "DimSize: expected whole numbers from 1 to 4294967295, found {}",
                 quoted(words[axis]));
        sizes[axis] = *size;
    }
    volume.dims = {sizes[0], sizes[1], sizes[2]};
    set_time(volume, sizes[3], options);
}

void set_world(Volume& volume, const MetaHeader& header, size_t dimension) {
    const auto spacing = numbers(header, {"ElementSpacing", "ElementSize"}, dimension);
    const auto origin = numbers(header, {"Offset", "Position", "Origin"}, dimension);
    const auto matrix =
        numbers(header, {"TransformMatrix", "Rotation", "Orientation"}, dimension * dimension);
    const size_t used = std::min<size_t>(dimension, 3);
    for (size_t axis = 0; axis < used; ++axis) {
        for (size_t row = 0; row < used; ++row) {
            const double direction =
                matrix.empty() ? (row == axis ? 1.0 : 0.0) : matrix[axis * dimension + row];
            volume.affine.m[row][axis] = direction * (spacing.empty() ? 1 : spacing[axis]);
        }
        if (!origin.empty()) volume.affine.m[axis][3] = origin[axis];
    }
    const std::string_view orientation = header.optional({"AnatomicalOrientation"}).value_or("");
    if (orientation.empty() || orientation.find('?') != std::string_view::npos) return;
    volume.space = Space::ras;
    volume.length_units = "mm";
    flip_world(volume.affine, {-1, -1, 1});
}

// HeaderSize counts from the start of the file, for LOCAL voxels too; -1: the voxels end the file.
void set_header_size(DataSource& source, const MetaHeader& header) {
    const auto text = header.optional({"HeaderSize"});
    if (!text) return;
    const auto size = parse_number<int64_t>(*text);
    if (!size || *size < -1)
        fail(header.path, "HeaderSize: expected a whole number, -1 or more, found {}",
             quoted(*text));
    if (*size == -1 && source.encoding != Encoding::raw)
        fail(header.path, "HeaderSize -1 needs raw voxels, not compressed or ASCII ones");
    source.at_end = *size == -1;
    if (*size > 0) source.offset = static_cast<uint64_t>(*size);
}

}  // namespace

OpenedFile open_metaimage(const std::string& path, const LoadOptions& options) {
    const VoxelBytes file = VoxelBytes::map(path, 0, file_size(path));
    const MetaHeader header =
        parse_header(path, {reinterpret_cast<const char*>(file.span().data()), file.span().size()});
    const auto dimension = parse_number<uint32_t>(header.required("NDims"));
    if (!dimension || *dimension < 2 || *dimension > 4)
        fail(path, "expected NDims 2, 3 or 4 (time), found {}", quoted(header.required("NDims")));
    const std::string_view channels = header.optional({"ElementNumberOfChannels"}).value_or("1");
    if (channels != "1")
        fail(path, "{} channels per voxel; only scalar volumes can be read", quoted(channels));
    Volume volume;
    volume.name = path;
    volume.type = voxel_type(header);
    set_dims(volume, header, *dimension, options);
    set_world(volume, header, *dimension);

    DataSource source{.files = header.files, .offset = header.data_offset};
    if (!header.flag({"BinaryData"}, true)) source.encoding = Encoding::ascii;
    // CompressedDataSize is not needed, and wrong in files that exist.
    if (header.flag({"CompressedData"}, false)) source.encoding = Encoding::compressed;
    source.big_endian = options.big_endian.value_or(
        header.flag({"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}, false));
    set_header_size(source, header);
    return {std::move(volume), std::move(source)};
}

}  // namespace isorast
