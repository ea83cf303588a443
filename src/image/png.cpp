// SPDX-License-Identifier: MIT
// PNG files, through libpng's simplified interface: it returns its errors, so no longjmp passes
// over our destructors. Text chunks, which that interface does not know, are put in behind the
// header by hand.
#include <fmt/format.h>
#include <isorast/error.h>
#include <isorast/image.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "image/whole_file.h"
#include "volume/utf8.h"

namespace isorast {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<uint8_t>;

constexpr size_t HEADER_END = 8 + 25;  // the signature and the IHDR chunk

// libpng's own struct, released on every way out.
struct Png : png_image {
    Png() : png_image{} { version = PNG_IMAGE_VERSION; }
    Png(const Png&) = delete;
    Png& operator=(const Png&) = delete;
    ~Png() { png_image_free(this); }
};

void append_big_endian(Bytes& bytes, uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8)
        bytes.push_back(static_cast<uint8_t>(value >> shift));
}

void append(Bytes& bytes, std::string_view text) {
    bytes.insert(bytes.end(), text.begin(), text.end());
}

bool is_ascii(std::string_view text) {
    return std::ranges::all_of(text, [](char c) { return (c & 0x80) == 0; });
}

// Length, type, keyword, zero, text, checksum. In an iTXt chunk two zeros more say that the text is
// not compressed, and one each ends its language and the translated keyword, which are empty.
void append_text_chunk(Bytes& bytes, const std::string& keyword, const std::string& text) {
    if (keyword.empty() || keyword.size() > 79) {
        throw Error(fmt::format("PNG text keyword \"{}\" must have 1 to 79 characters", keyword));
    }
    // tEXt is Latin-1, as which any bytes pass; iTXt is UTF-8.
    const bool international = !is_ascii(text) && is_utf8(text);
    const std::string zeros(international ? 5 : 1, '\0');
    append_big_endian(bytes, static_cast<uint32_t>(keyword.size() + zeros.size() + text.size()));
    const size_t start = bytes.size();
    append(bytes, international ? "iTXt" : "tEXt");
    append(bytes, keyword);
    append(bytes, zeros);
    append(bytes, text);
    const uLong checksum = crc32(0, bytes.data() + start, static_cast<uInt>(bytes.size() - start));
    append_big_endian(bytes, static_cast<uint32_t>(checksum));
}

Bytes read_bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file || fs::is_directory(path)) {
        throw Error(fmt::format("{}: cannot be read; expected a PNG file", path));
    }
    return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

std::vector<uint8_t> encode_png(const Image& image,
                                const std::vector<std::pair<std::string, std::string>>& text) {
    const size_t pixels = size_t{image.size.width} * image.size.height;
    if (pixels == 0 || image.rgba.size() != 4 * pixels) {
        throw Error(fmt::format("PNG: a picture of {}x{} cannot be written from {} bytes",
                                image.size.width, image.size.height, image.rgba.size()));
    }
    Png png;
    png.width = image.size.width;
    png.height = image.size.height;
    png.format = PNG_FORMAT_RGBA;  // 8 bits, sRGB, straight alpha: the sRGB chunk follows from it
    // Fast: a quarter of the time for at most half as many bytes more.
    png.flags = PNG_IMAGE_FLAG_FAST;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    Bytes bytes(size);
    if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr)) {
        throw Error(fmt::format("PNG: cannot be encoded: {}", png.message));
    }
    bytes.resize(size);
    Bytes chunks;
    for (const auto& [keyword, value] : text)
        append_text_chunk(chunks, keyword, value);
    bytes.insert(bytes.begin() + HEADER_END, chunks.begin(), chunks.end());
    return bytes;
}

void write_png(const std::string& path, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text) {
    WholeFile file(path);
    file.write(encode_png(image, text));
    file.finish();
}

Image read_png(const std::string& path) {
    const Bytes bytes = read_bytes(path);
    Png png;
    if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) {
        throw Error(fmt::format("{}: not a PNG file that can be read: {}", path, png.message));
    }
    // Deflate packs at most 1032 to 1 and a pixel has at least one bit: believe no larger header.
    const uint64_t pixels = uint64_t{png.width} * png.height;
    if (pixels / 8 > 1032 * uint64_t{bytes.size()}) {
        throw Error(
            fmt::format("{}: the header claims {}x{} pixels, too many for a file of {} bytes", path,
                        png.width, png.height, bytes.size()));
    }
    png.format = PNG_FORMAT_RGBA;
    png.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
    Image image{{png.width, png.height}, Bytes(4 * pixels), {}};
    if (!png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr)) {
        throw Error(fmt::format("{}: broken PNG file: {}", path, png.message));
    }
    return image;
}

}  // namespace isorast
