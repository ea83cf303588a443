// SPDX-License-Identifier: MIT
// Writes NIfTI files for the tests, field by field, so that any of them can be wrong.
#include "nifti_file.h"

#include <algorithm>
#include <cstring>

namespace isorast::test {
namespace {

class Bytes {
public:
    Bytes(size_t size, bool big_endian) : bytes_(size, '\0'), big_endian_(big_endian) {}
    template <class T, class Value>
    void put(size_t offset, Value value) {
        const T typed = static_cast<T>(value);
        char raw[sizeof(T)];
        std::memcpy(raw, &typed, sizeof(T));
        if (big_endian_) std::reverse(raw, raw + sizeof(T));
        bytes_.replace(offset, sizeof(T), raw, sizeof(T));
    }
    template <class T, class Values>
    void put_all(size_t offset, const Values& values) {
        for (const auto value : values) {
            put<T>(offset, value);
            offset += sizeof(T);
        }
    }
    void text(size_t offset, std::string_view text) { bytes_.replace(offset, text.size(), text); }
    const std::string& string() const { return bytes_; }

private:
    std::string bytes_;
    bool big_endian_;
};

// The offsets are those of the format's definition.
std::string nifti1(const NiftiFile& file) {
    Bytes bytes(352, file.big_endian);
    bytes.put<int32_t>(0, file.sizeof_hdr != 0 ? file.sizeof_hdr : 348);
    bytes.put_all<int16_t>(40, file.dim);
    bytes.put<int16_t>(70, file.datatype);
    bytes.put<int16_t>(72, file.bitpix);
    bytes.put_all<float>(76, file.pixdim);
    bytes.put<float>(108, file.vox_offset == -1 ? 352 : file.vox_offset);
    bytes.put<float>(112, file.slope);
    bytes.put<float>(116, file.intercept);
    bytes.put<int8_t>(123, file.units);
    bytes.put<int16_t>(252, file.qform_code);
    bytes.put<int16_t>(254, file.sform_code);
    bytes.put_all<float>(256, file.quaternion);
    bytes.put_all<float>(268, file.qoffset);
    bytes.put_all<float>(280, file.srow);
    bytes.text(344, file.magic.empty() ? std::string_view("n+1") : file.magic);
    return bytes.string();
}

std::string nifti2(const NiftiFile& file) {
    Bytes bytes(544, file.big_endian);
    bytes.put<int32_t>(0, file.sizeof_hdr != 0 ? file.sizeof_hdr : 540);
    bytes.text(4, file.magic.empty() ? std::string_view("n+2") : file.magic);
    bytes.text(8, "\r\n\032\n");
    bytes.put<int16_t>(12, file.datatype);
    bytes.put<int16_t>(14, file.bitpix);
    bytes.put_all<int64_t>(16, file.dim);
    bytes.put_all<double>(104, file.pixdim);
    bytes.put<int64_t>(168, file.vox_offset == -1 ? 544 : file.vox_offset);
    bytes.put<double>(176, file.slope);
    bytes.put<double>(184, file.intercept);
    bytes.put<int32_t>(344, file.qform_code);
    bytes.put<int32_t>(348, file.sform_code);
    bytes.put_all<double>(352, file.quaternion);
    bytes.put_all<double>(376, file.qoffset);
    bytes.put_all<double>(400, file.srow);
    bytes.put<int32_t>(500, file.units);
    return bytes.string();
}

}  // namespace

std::string NiftiFile::header() const {
    return version == 1 ? nifti1(*this) : nifti2(*this);
}

std::string NiftiFile::pair_header() const {
    NiftiFile pair = *this;
    pair.magic = version == 1 ? "ni1" : "ni2";
    if (pair.vox_offset == -1) pair.vox_offset = 0;
    return pair.header();
}

}  // namespace isorast::test
