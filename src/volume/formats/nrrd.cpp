// SPDX-License-Identifier: MIT
// NRRD (teem's "nearly raw raster data", format versions 1 to 5): a text header, then voxels in the
// same file or in others. This file reads the header; nrrd_axes.cpp gives its axes their meaning.
#include "volume/formats/nrrd.h"

#include "volume/formats/data.h"
#include "volume/formats/reader.h"

namespace isorast {
namespace {

// "data file" and "datafile" are the same field, in any case.
std::string normalised(std::string_view field) {
    std::string name = lowercase(trimmed(field));
    std::erase(name, ' ');
    return name;
}

// "LIST", "LIST 2", "slice%03d.raw 1 100 1 2" or a plain name.
void add_data_files(NrrdHeader& header, std::string_view value, Lines& lines) {
    auto words = split(value);
    if (!words.empty() && words[0] == "LIST") {
        header.files = listed_files(header.path, lines);
    } else if (words.size() > 2 && words[0].find('%') != std::string_view::npos) {
        if (words.size() > 4)
            words.resize(4);  // the dimension of a file follows from the count of files
        header.files = numbered_files(header.path, words);
    } else {
        header.files = {beside(header.path, value)};
    }
}

void add_line(NrrdHeader& header, std::string_view line, Lines& lines) {
    const size_t colon = line.find(':');
    if (colon == std::string_view::npos)
        fail(header.path, "expected \"field: value\" in the NRRD header, found {}", quoted(line));
    if (line.substr(colon).starts_with(":=")) return;  // a key of the user's own
    const std::string field = normalised(line.substr(0, colon));
    const std::string_view value = trimmed(line.substr(colon + 1));
    if (!header.fields.emplace(field, value).second)
        fail(header.path, "the NRRD header gives {} twice", quoted(field));
    if (field == "datafile") add_data_files(header, value, lines);
}

NrrdHeader parse_header(const std::string& path, std::string_view text) {
    NrrdHeader header{.path = path, .fields = {}, .files = {}, .data_offset = 0};
    Lines lines(text);
    const auto magic = lines.next().value_or("");
    if (!magic.starts_with("NRRD000") || magic.size() != 8)
        fail(path, "expected NRRD0001 to NRRD0005 in the first line, found {}", quoted(magic));
    bool ended = false;
    while (const auto line = lines.next()) {
        ended = line->empty();
        if (ended) break;
        if (!line->starts_with('#')) add_line(header, *line, lines);
    }
    if (header.fields.contains("datafile")) return header;
    if (!ended) fail(path, "no empty line ends the NRRD header, and it names no data file");
    header.files = {path};
    header.data_offset = lines.consumed();
    return header;
}

VoxelType voxel_type(const NrrdHeader& header) {
    const std::string_view word = header.required("type");
    const auto type = parse_voxel_type(word);
    if (!type)
        fail(header.path,
             "expected a scalar NRRD type of 8, 16 or 32 bits, float or double, found {}",
             quoted(word));
    return *type;
}

Encoding encoding(const NrrdHeader& header) {
    const std::string word = lowercase(header.required("encoding"));
    if (word == "raw") return Encoding::raw;
    if (word == "gzip" || word == "gz") return Encoding::compressed;
    if (word == "ascii" || word == "text" || word == "txt") return Encoding::ascii;
    fail(header.path,
         "expected NRRD encoding raw, gzip or ascii, found {}; convert it with "
         "\"unu save -e gzip\"",
         quoted(word));
}

int64_t whole_number(const NrrdHeader& header, const std::string& field, int64_t least) {
    const auto text = header.optional(field);
    if (!text) return 0;
    const auto number = parse_number<int64_t>(*text);
    if (!number || *number < least)
        fail(header.path, "{}: expected a whole number, {} or more, found {}", field, least,
             quoted(*text));
    return *number;
}

bool big_endian(const NrrdHeader& header, const LoadOptions& options, bool matters) {
    if (options.big_endian) return *options.big_endian;
    const auto word = header.optional("endian");
    if (!word && matters)
        fail(header.path,
             "the NRRD header does not give the endian of its voxels; give it as an option");
    if (!word || lowercase(*word) == "little") return false;
    if (lowercase(*word) == "big") return true;
    fail(header.path, "expected endian little or big, found {}", quoted(*word));
}

}  // namespace

std::optional<std::string_view> NrrdHeader::optional(const std::string& field) const {
    const auto found = fields.find(field);
    if (found == fields.end()) return std::nullopt;
    return found->second;
}

std::string_view NrrdHeader::required(const std::string& field) const {
    const auto value = optional(field);
    if (!value || value->empty()) fail(path, "the NRRD header does not give \"{}\"", field);
    return *value;
}

OpenedFile open_nrrd(const std::string& path, const LoadOptions& options) {
    const VoxelBytes file = VoxelBytes::map(path, 0, file_size(path));
    const NrrdHeader header =
        parse_header(path, {reinterpret_cast<const char*>(file.span().data()), file.span().size()});
    Volume volume;
    volume.name = path;
    volume.type = voxel_type(header);
    set_nrrd_axes(volume, header, options);

    DataSource source{
        .files = header.files, .encoding = encoding(header), .offset = header.data_offset};
    source.big_endian = big_endian(header, options,
                                   bytes_of(volume.type) > 1 && source.encoding != Encoding::ascii);
    source.skip_lines = static_cast<uint64_t>(whole_number(header, "lineskip", 0));
    const int64_t skip = whole_number(header, "byteskip", -1);
    source.at_end = skip == -1;
    if (source.at_end && source.encoding != Encoding::raw)
        fail(path, "byte skip -1 needs encoding raw, found {}",
             quoted(header.required("encoding")));
    // In compressed data the bytes to skip are counted after inflation, the lines before.
    if (source.encoding == Encoding::compressed)
        source.skip_inflated = static_cast<uint64_t>(skip);
    else if (!source.at_end)
        source.skip_bytes = static_cast<uint64_t>(skip);
    return {std::move(volume), std::move(source)};
}

}  // namespace isorast
