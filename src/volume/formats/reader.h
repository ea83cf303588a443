// SPDX-License-Identifier: MIT
// What every reader offers to the table in load.cpp. A reader sets dims, type and whatever the file
// says about the world, values and time, and where the voxels lie; load_volume reads these, adds
// the spacing asked for, and the final check.
#pragma once
#include "volume/formats/data.h"

namespace isorast {

// A file whose header has been read: its Volume without voxels, and where these lie.
struct OpenedFile {
    Volume volume;
    DataSource source;
};

OpenedFile open_raw(const std::string& path, const LoadOptions& options);
OpenedFile open_nrrd(const std::string& path, const LoadOptions& options);
OpenedFile open_metaimage(const std::string& path, const LoadOptions& options);
OpenedFile open_nifti(const std::string& path, const LoadOptions& options);

// Any file by the reader that takes it, with the spacing of the options.
OpenedFile open_file(const std::string& path, const LoadOptions& options);

// The format that the file's ending stands for; empty when it is none of ours.
std::string_view format_of_ending(const std::string& path);
// "NRRD (.nrrd .nhdr), ...".
std::string known_formats();

// Whether the file's name gives the dimensions: "_256x256x128_uint8" or "_256_256_128_1_1".
bool is_raw_name(const std::string& path);

}  // namespace isorast
