// SPDX-License-Identifier: MIT
// What every reader offers to the table in load.cpp. A reader sets dims, type, bytes and whatever
// the file says about the world, values and time; load_volume adds the name, the spacing asked for,
// and the final check.
#pragma once
#include <isorast/load.h>

namespace isorast {

Volume load_raw(const std::string& path, const LoadOptions& options);
Volume load_nrrd(const std::string& path, const LoadOptions& options);
Volume load_metaimage(const std::string& path, const LoadOptions& options);
Volume load_nifti(const std::string& path, const LoadOptions& options);

// The format that the file's ending stands for; empty when it is none of ours.
std::string_view format_of_ending(const std::string& path);
// "NRRD (.nrrd .nhdr), ...".
std::string known_formats();

// Whether the file's name gives the dimensions: "_256x256x128_uint8" or "_256_256_128_1_1".
bool is_raw_name(const std::string& path);

}  // namespace isorast
