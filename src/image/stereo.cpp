// SPDX-License-Identifier: MIT
// Arranging two eyes' pictures. The anaglyph is for red-cyan glasses: each eye gets, through its
// filter, the nearest colours to its picture (Dubois 2001, least squares; his matrices for sRGB
// monitors as McAllister, Zhou and Sullivan 2010 print them, table 1).
#include "image/stereo.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace isorast {

namespace {

template <class T>
std::vector<T> side_by_side(const std::vector<T>& layers, size_t row, size_t rows) {
    std::vector<T> result(layers.size());
    for (size_t y = 0; y < rows; ++y)
        for (size_t eye = 0; eye < 2; ++eye)
            std::copy_n(layers.begin() + ptrdiff_t((eye * rows + y) * row), row,
                        result.begin() + ptrdiff_t((2 * y + eye) * row));
    return result;
}

double to_linear(double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

uint8_t to_srgb(double c) {
    c = std::clamp(c, 0.0, 1.0);
    c = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    return uint8_t(std::lround(255 * c));
}

constexpr double LEFT[3][3] = {
    {0.437, 0.449, 0.164}, {-0.062, -0.062, -0.024}, {-0.048, -0.050, -0.017}};
constexpr double RIGHT[3][3] = {
    {-0.011, -0.032, -0.007}, {0.377, 0.761, 0.009}, {-0.026, -0.093, 1.234}};

void mix_anaglyph(const uint8_t* left, const uint8_t* right, uint8_t* out) {
    static const auto LINEAR = [] {
        std::array<double, 256> table{};
        for (size_t i = 0; i < table.size(); ++i)
            table[i] = to_linear(double(i) / 255);
        return table;
    }();
    for (size_t row = 0; row < 3; ++row) {
        double sum = 0;
        for (size_t i = 0; i < 3; ++i)
            sum += LEFT[row][i] * LINEAR[left[i]] + RIGHT[row][i] * LINEAR[right[i]];
        out[row] = to_srgb(sum);
    }
    out[3] = std::max(left[3], right[3]);
}

}  // namespace

Image arrange(Image layers, StereoMode mode) {
    const size_t width = layers.size.width, height = layers.size.height / 2;
    if (mode == StereoMode::side_by_side) {
        layers.size = {uint32_t(2 * width), uint32_t(height)};
        layers.rgba = side_by_side(layers.rgba, 4 * width, height);
        if (!layers.depth.empty()) layers.depth = side_by_side(layers.depth, width, height);
    } else if (mode == StereoMode::anaglyph) {
        layers.size.height = uint32_t(height);
        const size_t pixels = width * height;
        for (size_t i = 0; i < pixels; ++i)
            mix_anaglyph(&layers.rgba[4 * i], &layers.rgba[4 * (pixels + i)], &layers.rgba[4 * i]);
        layers.rgba.resize(4 * pixels);
        if (!layers.depth.empty()) layers.depth.resize(pixels);  // the left eye's
    }
    return layers;
}

}  // namespace isorast
