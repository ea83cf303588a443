// SPDX-License-Identifier: MIT
// Pictures in memory: a pixel, the comparison of two pictures, and the picture of their difference.
#include <fmt/format.h>
#include <isorast/error.h>
#include <isorast/image.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace isorast {
namespace {

void require_same_size(const Image& a, const Image& b) {
    for (const Image* image : {&a, &b}) {
        const size_t expected = size_t{4} * image->size.width * image->size.height;
        if (image->rgba.size() != expected) {
            throw Error(fmt::format("compare: a picture of {}x{} should have {} bytes and has {}",
                                    image->size.width, image->size.height, expected,
                                    image->rgba.size()));
        }
    }
    if (a.size != b.size) {
        throw Error(fmt::format(
            "compare: the pictures differ in size, {}x{} and {}x{}; render both at the same size",
            a.size.width, a.size.height, b.size.width, b.size.height));
    }
}

}  // namespace

std::array<uint8_t, 4> Image::pixel(uint32_t x, uint32_t y) const {
    const size_t at = 4 * (size_t{y} * size.width + x);
    return {rgba.at(at), rgba.at(at + 1), rgba.at(at + 2), rgba.at(at + 3)};
}

Difference compare(const Image& a, const Image& b, double tolerance) {
    require_same_size(a, b);
    if (!(tolerance >= 0)) throw Error("compare: the tolerance must be 0 or more");
    Difference difference;
    uint64_t squares = 0;
    int maximum = 0;
    for (size_t at = 0; at < a.rgba.size(); at += 4) {
        int largest = 0;
        for (size_t c = at; c < at + 4; ++c) {
            const int d = std::abs(a.rgba[c] - b.rgba[c]);
            largest = std::max(largest, d);
            squares += static_cast<uint64_t>(d * d);
        }
        maximum = std::max(maximum, largest);
        if (largest > tolerance) ++difference.pixels_over;
    }
    if (a.rgba.empty()) return difference;
    const double channels = static_cast<double>(a.rgba.size());
    difference.maximum = maximum;
    difference.root_mean_square = std::sqrt(static_cast<double>(squares) / channels);
    difference.share_over = static_cast<double>(difference.pixels_over) * 4 / channels;
    return difference;
}

Image difference_picture(const Image& a, const Image& b, double tolerance) {
    require_same_size(a, b);
    const double gain = 128 / std::max(tolerance, 1.0);
    Image picture{a.size, std::vector<uint8_t>(a.rgba.size()), {}};
    for (size_t at = 0; at < a.rgba.size(); at += 4) {
        // A difference in alpha alone must show too: it lifts all three colours.
        const int alpha = std::abs(a.rgba[at + 3] - b.rgba[at + 3]);
        for (size_t c = at; c < at + 3; ++c) {
            const int d = std::max(alpha, std::abs(a.rgba[c] - b.rgba[c]));
            picture.rgba[c] = static_cast<uint8_t>(std::min(255.0, d * gain));
        }
        picture.rgba[at + 3] = 255;
    }
    return picture;
}

}  // namespace isorast
