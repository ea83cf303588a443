// SPDX-License-Identifier: MIT
// Pictures: pixels in memory, comparison of two, PNG files.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace isorast {

struct Size {
    uint32_t width = 1280, height = 720;
    bool operator==(const Size&) const = default;
};

struct Image {
    Size size;
    std::vector<uint8_t> rgba;  // 4 bytes a pixel, sRGB, straight alpha; rows from the top
    // Distance from the eye's plane to the surface along the viewing direction, world units, a
    // value a pixel; infinity where there is no surface. Of an anaglyph, the left eye's. Empty
    // unless Frame::want_depth.
    std::vector<float> depth;

    std::array<uint8_t, 4> pixel(uint32_t x, uint32_t y) const;
};

struct Difference {
    double maximum = 0;           // largest difference of a channel, 0 to 255
    double root_mean_square = 0;  // over all channels, 0 to 255
    uint64_t pixels_over = 0;     // pixels with a channel that differs by more than the tolerance
    double share_over = 0;        // the same as a share of all pixels
};
// Throws Error when sizes differ or the tolerance is negative. `tolerance` is in channel units, 0
// to 255.
Difference compare(const Image& a, const Image& b, double tolerance = 0);
// |a - b|, amplified so that a difference of `tolerance` (at least 1) shows as mid grey. Throws
// Error when sizes differ.
Image difference_picture(const Image& a, const Image& b, double tolerance = 1);

// PNG, 8 bits a channel, sRGB; `text` pairs become tEXt chunks, or iTXt where the value is UTF-8
// but not ASCII. These need libpng: not in the core. Throws Error for a picture without pixels or
// of other than 4 bytes a pixel, and for text keywords of other than 1 to 79 characters.
std::vector<uint8_t> encode_png(const Image& image,
                                const std::vector<std::pair<std::string, std::string>>& text = {});
// The file appears whole or not at all. Throws Error too when it cannot be written.
void write_png(const std::string& path, const Image& image,
               const std::vector<std::pair<std::string, std::string>>& text = {});
// Any kind of PNG; 16 bits are reduced to 8. Throws Error with the reason.
Image read_png(const std::string& path);

}  // namespace isorast
