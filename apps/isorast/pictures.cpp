// SPDX-License-Identifier: MIT
// Pictures to files; see pictures.h.
#include "pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

namespace isorast::cli {

std::string default_output(const std::string& input, bool several) {
    std::string name = input;
    if (is_procedural(input)) {
        std::ranges::replace_if(name, [](char c) { return c == ':' || c == '/'; }, '-');
    } else {
        std::filesystem::path path = std::filesystem::absolute(input).lexically_normal();
        path = path.has_filename() ? path.filename() : path.parent_path().filename();
        if (path.extension() == ".gz") path = path.stem();
        name = path.stem().string();
    }
    return name + (several ? "_{time:4}.png" : ".png");
}

std::string difference_path(const std::string& output) {
    return std::filesystem::path(output).replace_extension(".difference.png").string();
}

bool shows_only_background(const Image& image, const Color& background, bool anaglyph) {
    const auto channel = [](float value) { return uint8_t(std::lround(255 * value)); };
    std::array<uint8_t, 4> empty{channel(background.r), channel(background.g),
                                 channel(background.b), channel(background.a)};
    if (anaglyph) empty = image.pixel(0, 0);
    for (size_t at = 0; at < image.rgba.size(); at += empty.size())
        if (!std::equal(empty.begin(), empty.end(), image.rgba.begin() + ptrdiff_t(at)))
            return false;
    return true;
}

Written write_picture(const Image& image, const std::string& path, bool layers,
                      const std::vector<std::pair<std::string, std::string>>& text) {
    if (layers) {
        Written written{.files = {}, .size = {image.size.width, image.size.height / 2}};
        const size_t half = image.rgba.size() / 2;
        for (const auto& [name, begin] :
             {std::pair{".left.png", size_t{0}}, {".right.png", half}}) {
            const auto first = image.rgba.begin() + ptrdiff_t(begin);
            const Image eye{.size = written.size, .rgba = {first, first + ptrdiff_t(half)}};
            written.files.push_back(std::filesystem::path(path).replace_extension(name).string());
            write_png(written.files.back(), eye, text);
        }
        return written;
    }
    if (path != "-") {
        write_png(path, image, text);
        return {{path}, image.size};
    }
    const std::vector<uint8_t> bytes = encode_png(image, text);
    print({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    flush_output();
    return {{path}, image.size};
}

}  // namespace isorast::cli
