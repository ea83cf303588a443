// SPDX-License-Identifier: MIT
// The header of a NRRD file, as text, between the two files that read it.
#pragma once
#include <isorast/load.h>

#include <map>

namespace isorast {

struct NrrdHeader {
    std::string path;
    std::map<std::string, std::string, std::less<>> fields;  // names in lower case without spaces
    std::vector<std::string> files;
    uint64_t data_offset = 0;  // in each of the files

    std::optional<std::string_view> optional(const std::string& field) const;
    std::string_view required(const std::string& field) const;  // throws Error when absent or empty
};

// Sets dims, time, affine, space and units. Throws Error for axes that hold something but space or
// time.
void set_nrrd_axes(Volume& volume, const NrrdHeader& header, const LoadOptions& options);

}  // namespace isorast
