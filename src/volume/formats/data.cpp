// SPDX-License-Identifier: MIT
// From "where the header says the voxels lie" to voxels in memory, the same way for all formats.
#include "volume/formats/data.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <new>

#include "volume/formats/inflate.h"
#include "volume/voxels.h"

namespace isorast {
namespace {

// One file's share of the voxels, and the window of it that belongs to the time step wanted; in
// bytes.
struct Part {
    const std::string& file;
    uint64_t share, skip, take;
};

std::string_view text_of(const VoxelBytes& bytes) {
    return {reinterpret_cast<const char*>(bytes.span().data()), bytes.span().size()};
}

uint64_t after_lines(const Part& part, const DataSource& source, uint64_t size) {
    if (source.skip_lines == 0) return 0;
    const VoxelBytes bytes = VoxelBytes::map(part.file, source.offset, size - source.offset);
    Lines lines(text_of(bytes));
    for (uint64_t line = 0; line < source.skip_lines; ++line)
        if (!lines.next())
            fail(part.file, "expected {} lines before the data, found {}", source.skip_lines, line);
    return lines.consumed();
}

// Where in its file the part's data begin.
uint64_t begin_of(const Part& part, const DataSource& source, uint64_t size) {
    if (source.at_end) {
        if (part.share > size)
            fail(part.file, "expected at least {} bytes, found {}", part.share, size);
        return size - part.share;
    }
    uint64_t begin = source.offset;
    if (begin <= size) begin += after_lines(part, source, size);
    if (__builtin_add_overflow(begin, source.skip_bytes, &begin) || begin >= size)
        fail(part.file, "expected data from byte {} on, found {} bytes in the file", begin, size);
    return begin;
}

VoxelBytes map_raw(const Volume& volume, const DataSource& source, const Part& part) {
    const uint64_t size = file_size(part.file);
    const uint64_t begin = begin_of(part, source, size);
    if (size - begin != part.share) {
        const std::string steps =
            volume.time_steps > 1 ? fmt::format(" in {} time steps", volume.time_steps) : "";
        const std::string shared =
            source.files.size() > 1 ? fmt::format(" in {} files", source.files.size()) : "";
        fail(part.file,
             "expected {} bytes{} for {}x{}x{} {}{}{}, found {}; is the file complete, and "
             "are dimensions, type and offset right?",
             part.share, begin > 0 ? fmt::format(" from byte {} on", begin) : "", volume.dims[0],
             volume.dims[1], volume.dims[2], name_of(volume.type), steps, shared, size - begin);
    }
    return VoxelBytes::map(part.file, begin + part.skip, part.take);
}

template <class T>
std::optional<T> parse_voxel(std::string_view word) {
    if (const auto number = parse_number<T>(word)) return number;
    if constexpr (std::is_same_v<T, float>) {
        // Too small for a float is no error, too large is.
        const auto wide = parse_number<double>(word);
        if (wide && std::abs(*wide) < 1) return static_cast<float>(*wide);
    }
    return std::nullopt;
}

template <class T>
void append_ascii(const Part& part, std::string_view text, std::vector<std::byte>& out) {
    constexpr std::string_view separators = " \t\r\n\v\f,";
    const uint64_t count = part.share / sizeof(T), first = part.skip / sizeof(T);
    const uint64_t last = first + part.take / sizeof(T);
    if (count > (text.size() + 1) / 2)
        fail(part.file, "expected {} numbers, but {} bytes of text cannot hold so many", count,
             text.size());
    out.reserve(out.size() + part.take);
    size_t at = 0;
    const auto next_word = [&] {
        at = std::min(text.find_first_not_of(separators, at), text.size());
        const size_t end = std::min(text.find_first_of(separators, at), text.size());
        const std::string_view word = text.substr(at, end - at);
        at = end;
        return word;
    };
    for (uint64_t index = 0; index < count; ++index) {
        const std::string_view word = next_word();
        if (word.empty()) fail(part.file, "expected {} numbers, found {}", count, index);
        const auto value = parse_voxel<T>(word);
        if (!value)
            fail(part.file, "number {} of {} is {}, which is not a value of its type", index + 1,
                 count, quoted(word));
        if (index < first || index >= last) continue;
        const auto* bytes = reinterpret_cast<const std::byte*>(&*value);
        out.insert(out.end(), bytes, bytes + sizeof(T));
    }
    if (!next_word().empty()) fail(part.file, "expected {} numbers, found more", count);
}

std::unique_ptr<InflateStream> open_stream(const Part& part, const DataSource& source) {
    const uint64_t size = file_size(part.file), begin = begin_of(part, source, size);
    uint64_t expected = 0;
    if (__builtin_add_overflow(source.skip_inflated, part.share, &expected))
        fail(part.file, "{} bytes to skip are too many", source.skip_inflated);
    return std::make_unique<InflateStream>(
        part.file, VoxelBytes::map(part.file, begin, size - begin), expected);
}

void append(const Volume& volume, const DataSource& source, const Part& part,
            std::vector<std::byte>& out) {
    if (source.encoding == Encoding::raw) {
        const VoxelBytes bytes = map_raw(volume, source, part);
        out.insert(out.end(), bytes.span().begin(), bytes.span().end());
        return;
    }
    if (source.encoding == Encoding::compressed) {
        const auto stream = open_stream(part, source);
        stream->skip(source.skip_inflated + part.skip);
        stream->append(part.take, out);
        stream->finish();
        return;
    }
    const uint64_t size = file_size(part.file), begin = begin_of(part, source, size);
    const VoxelBytes bytes = VoxelBytes::map(part.file, begin, size - begin);
    with_type(volume.type,
              [&](auto zero) { append_ascii<decltype(zero)>(part, text_of(bytes), out); });
}

template <class Word>
void swap_words(std::span<std::byte> bytes) {
    for (size_t at = 0; at + sizeof(Word) <= bytes.size(); at += sizeof(Word)) {
        Word word;
        std::memcpy(&word, bytes.data() + at, sizeof(Word));
        if constexpr (sizeof(Word) == 2) word = __builtin_bswap16(word);
        if constexpr (sizeof(Word) == 4) word = __builtin_bswap32(word);
        if constexpr (sizeof(Word) == 8) word = __builtin_bswap64(word);
        std::memcpy(bytes.data() + at, &word, sizeof(Word));
    }
}

void swap_bytes(VoxelType type, std::span<std::byte> bytes) {
    if (bytes_of(type) == 2) swap_words<uint16_t>(bytes);
    if (bytes_of(type) == 4) swap_words<uint32_t>(bytes);
    if (bytes_of(type) == 8) swap_words<uint64_t>(bytes);
}

// The files that hold bytes [first, first + count) of all voxels, with their windows.
std::vector<Part> parts_of(const DataSource& source, uint64_t share, uint64_t first,
                           uint64_t count) {
    std::vector<Part> parts;
    for (uint64_t file = first / share; file < source.files.size() && file * share < first + count;
         ++file) {
        const uint64_t start = std::max(first, file * share);
        const uint64_t end = std::min(first + count, (file + 1) * share);
        parts.push_back({source.files[file], share, start - file * share, end - start});
    }
    return parts;
}

bool is_swapped(const Volume& volume, const DataSource& source) {
    return source.big_endian != (std::endian::native == std::endian::big) &&
           bytes_of(volume.type) > 1 && source.encoding != Encoding::ascii;
}

// Bytes of all time steps.
uint64_t total_bytes(const Volume& volume) {
    const uint64_t step = checked_byte_count(volume);
    uint64_t total = 0;
    if (__builtin_mul_overflow(step, volume.time_steps, &total) || total > INT64_MAX)
        fail(volume.name, "{} time steps of {} bytes are more than 63 bits can count",
             volume.time_steps, step);
    return total;
}

void read_parts(Volume& volume, const DataSource& source) {
    const uint64_t total = total_bytes(volume), step = volume.byte_count();
    const uint64_t count = source.files.size();
    if (count == 0) fail(volume.name, "the header names no data file");
    if (total % count != 0 || (total / count) % bytes_of(volume.type) != 0)
        fail(volume.name, "{} bytes cannot lie in {} data files of equal size", total, count);
    const auto parts = parts_of(source, total / count, step * volume.time_step, step);

    const bool swapped = is_swapped(volume, source);
    if (source.encoding == Encoding::raw && parts.size() == 1 && !swapped) {
        volume.bytes = map_raw(volume, source, parts[0]);
        return;
    }
    // Look at all sizes first: then the files justify the allocation.
    if (source.encoding == Encoding::raw)
        for (const Part& part : parts)
            map_raw(volume, source, part);
    std::vector<std::byte> voxels;
    if (source.encoding == Encoding::raw) voxels.reserve(step);
    for (const Part& part : parts)
        append(volume, source, part, voxels);
    if (swapped) swap_bytes(volume.type, voxels);
    volume.bytes = VoxelBytes::own(std::move(voxels));
}

}  // namespace

uint64_t file_size(const std::string& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found) fail(path, "there is no such file");
    if (error) fail(path, "cannot be opened: {}", error.message());
    if (std::filesystem::is_directory(status)) fail(path, "expected a file, found a directory");
    if (!std::filesystem::is_regular_file(status)) fail(path, "expected a regular file");
    const uint64_t size = std::filesystem::file_size(path, error);
    if (error) fail(path, "its size cannot be read: {}", error.message());
    if (size == 0) fail(path, "the file is empty");
    return size;
}

void set_time(Volume& volume, uint64_t steps, const LoadOptions& options) {
    if (steps > UINT32_MAX)
        fail(volume.name, "{} time steps are more than 32 bits can count", steps);
    if (options.time_step >= steps)
        fail(volume.name, "time step {} was asked for, but the file holds {}, counted from 0",
             options.time_step, steps);
    volume.time_steps = static_cast<uint32_t>(steps);
    volume.time_step = options.time_step;
}

// What is wrong with a data file is wrong with the file that the user named.
[[noreturn]] void rethrow_for(const Volume& volume, const Error& error) {
    if (std::string_view(error.what()).starts_with(volume.name)) throw error;
    fail(volume.name, "{}", error.what());
}

[[noreturn]] void fail_for_memory(const Volume& volume) {
    fail(
        volume.name,
        "expected memory for its voxels, {} bytes, found less; one uncompressed little-endian file "
        "needs none",
        volume.byte_count());
}

void read_voxels(Volume& volume, const DataSource& source) try {
    read_parts(volume, source);
} catch (const Error& error) {
    rethrow_for(volume, error);
} catch (const std::bad_alloc&) {
    fail_for_memory(volume);
}

StepReader::StepReader(const Volume& header, DataSource source)
    : header_(header_of(header)), source_(std::move(source)) {}
StepReader::StepReader(const StepReader& other) : StepReader(other.header_, other.source_) {}
StepReader::StepReader(StepReader&&) noexcept = default;
StepReader::~StepReader() = default;

Volume StepReader::operator()(uint32_t step) {
    Volume volume = header_of(header_);
    volume.time_step = step;
    const bool in_stream = source_.encoding == Encoding::compressed && source_.files.size() == 1;
    if (in_stream && volume.time_steps > 1)
        inflate_step(volume);
    else
        read_voxels(volume, source_);
    check(volume);
    return volume;
}

void StepReader::inflate_step(Volume& volume) try {
    const Part whole{source_.files[0], total_bytes(volume), 0, 0};
    const uint64_t bytes = volume.byte_count();
    const uint64_t first = source_.skip_inflated + bytes * volume.time_step;
    if (!stream_ || stream_->position() > first) stream_ = open_stream(whole, source_);
    std::vector<std::byte> voxels;
    stream_->skip(first - stream_->position());
    stream_->append(bytes, voxels);
    if (volume.time_step + 1 == volume.time_steps) stream_->finish();
    if (is_swapped(volume, source_)) swap_bytes(volume.type, voxels);
    volume.bytes = VoxelBytes::own(std::move(voxels));
} catch (const Error& error) {
    stream_.reset();
    rethrow_for(volume, error);
} catch (const std::bad_alloc&) {
    stream_.reset();
    fail_for_memory(volume);
}

std::string beside(const std::string& header, std::string_view name) {
    return (std::filesystem::path(header).parent_path() / name).string();
}

void flip_world(Affine& affine, std::array<double, 3> signs) {
    for (int row = 0; row < 3; ++row)
        for (double& entry : affine.m[row])
            entry *= signs[row];
}

}  // namespace isorast
