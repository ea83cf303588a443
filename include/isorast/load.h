// SPDX-License-Identifier: MIT
// From files to Volumes and Series. This part of the library needs the format libraries; the core
// does not.
#pragma once
#include <isorast/series.h>

namespace isorast {

// What a raw file does not say about itself, and overrides for files that do.
struct LoadOptions {
    std::optional<std::array<uint32_t, 3>> dims;
    std::optional<VoxelType> type;
    std::optional<bool> big_endian;
    uint64_t offset = 0;  // bytes to skip in a raw file
    std::optional<std::array<double, 3>> spacing;
    uint32_t time_step = 0;
};

// `path` is a file or a formula ("sphere:64"). Uncompressed voxels in native byte order are
// memory-mapped. Throws Error: one line with the file, what was expected, what was found, and what
// to do. Nothing is allocated that the file's own size does not justify.
Volume load_volume(const std::string& path, const LoadOptions& options = {});

// The time steps of one file or formula ("coral:64:steps=30"); of several files, a step each; or of
// the files in a directory, which must be of one format, in the order of the numbers in their names
// (t2 before t10). Throws Error for a file whose header does not go with the first one's; voxels
// are read by Series::load alone. LoadOptions::time_step does not count.
Series open_series(const std::vector<std::string>& paths, const LoadOptions& options = {});

}  // namespace isorast
