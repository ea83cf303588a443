// SPDX-License-Identifier: MIT
// A histogram drawn with block characters.
#pragma once
#include <isorast/volume.h>

namespace isorast::cli {

// Lines of at most `width` columns: counts on a logarithmic scale, the axis in data units, and a
// mark below the axis at `isovalue`.
std::string draw_histogram(const Statistics& statistics, const Volume& volume, double isovalue,
                           size_t width);

// Columns of the terminal, else $COLUMNS, else 80.
size_t terminal_width();

}  // namespace isorast::cli
