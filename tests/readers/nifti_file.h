// SPDX-License-Identifier: MIT
// Writes NIfTI files for the tests, field by field, so that any of them can be wrong.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace isorast::test {

struct NiftiFile {
    int version = 1;
    bool big_endian = false;
    std::array<int64_t, 8> dim{3, 4, 3, 2, 1, 1, 1, 1};
    int datatype = 4, bitpix = 16;  // int16
    std::array<double, 8> pixdim{1, 1, 1, 1, 1, 1, 1, 1};
    double slope = 0, intercept = 0;
    int units = 2;  // mm
    int qform_code = 0, sform_code = 0;
    std::array<double, 3> quaternion{}, qoffset{};
    std::array<double, 12> srow{};
    double vox_offset = -1;  // -1: right behind the header
    std::string_view magic;  // empty: that of one file
    int32_t sizeof_hdr = 0;  // 0: that of the version

    // Header and the four bytes that say "no extension".
    std::string header() const;
    // The header of a .hdr file whose voxels are in a .img file.
    std::string pair_header() const;
};

}  // namespace isorast::test
