// SPDX-License-Identifier: MIT
// The files that `render` writes: their default names, and what is in them.
#pragma once
#include <utility>

#include "options.h"

namespace isorast::cli {

// The input's name without its extensions, in the current folder; a formula's with '-' for ':'.
std::string default_output(const std::string& input, bool several);
// a/b.png -> a/b.difference.png
std::string difference_path(const std::string& output);

struct Written {
    std::vector<std::string> files;
    Size size;  // of each
};

// Whether no pixel shows anything but the background. The color of an anaglyph's is not known:
// there, whether all pixels are alike.
bool shows_only_background(const Image& image, const Color& background, bool anaglyph);

// To a PNG file with these texts, or, "-", to standard output. Two eyes in `layers` become two
// files: picture.png becomes picture.left.png and picture.right.png. Throws Error.
Written write_picture(const Image& image, const std::string& path, bool layers,
                      const std::vector<std::pair<std::string, std::string>>& text);

}  // namespace isorast::cli
