// SPDX-License-Identifier: MIT
// The words for the renderer's choices: the same in C++, on the command line and in pictures'
// metadata.
#include <isorast/renderer.h>

#include <array>

namespace isorast {

namespace {

constexpr std::array<std::string_view, 3> RASTERIZERS{"auto", "hardware", "compute"};
constexpr std::array<std::string_view, 6> SHADINGS{"gooch", "phong",  "normals",
                                                   "depth", "blocks", "forward"};
constexpr std::array<std::string_view, 3> OCCLUSIONS{"auto", "raster", "hiz"};
constexpr std::array<std::string_view, 4> STEREO_MODES{"off", "side-by-side", "anaglyph", "layers"};

template <class Enum, size_t N>
std::optional<Enum> parse(const std::array<std::string_view, N>& words, std::string_view word) {
    for (size_t i = 0; i < N; ++i)
        if (words[i] == word) return Enum(i);
    return std::nullopt;
}

}  // namespace

std::string_view name_of(Rasterizer rasterizer) {
    return RASTERIZERS[size_t(rasterizer)];
}
std::string_view name_of(Shading shading) {
    return SHADINGS[size_t(shading)];
}
std::string_view name_of(Occlusion occlusion) {
    return OCCLUSIONS[size_t(occlusion)];
}
std::string_view name_of(StereoMode mode) {
    return STEREO_MODES[size_t(mode)];
}
std::optional<Occlusion> parse_occlusion(std::string_view word) {
    return parse<Occlusion>(OCCLUSIONS, word);
}
std::optional<StereoMode> parse_stereo(std::string_view word) {
    return parse<StereoMode>(STEREO_MODES, word);
}
std::optional<Rasterizer> parse_rasterizer(std::string_view word) {
    return parse<Rasterizer>(RASTERIZERS, word);
}
std::optional<Shading> parse_shading(std::string_view word) {
    return parse<Shading>(SHADINGS, word);
}

}  // namespace isorast
