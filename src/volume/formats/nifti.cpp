// SPDX-License-Identifier: MIT
// NIfTI-1 and NIfTI-2 (.nii, .hdr and .img, each also gzipped). libnifti turns the header into
// affines and units. The header is checked before it sees it, because it repairs or reports on
// stderr what we want to refuse, and the voxels are read by read_voxels, which maps them and never
// trusts the header's sizes.
#include <nifti2_io.h>
#include <zlib.h>

#include <bit>
#include <cstring>
#include <memory>

#include "volume/formats/data.h"
#include "volume/formats/reader.h"

namespace isorast {
namespace {

using Image = std::unique_ptr<nifti_image, void (*)(nifti_image*)>;

struct NiftiFile {
    std::string header, data;
    Image image{nullptr, nifti_image_free};
    uint64_t offset = 0;
};

// The header file that belongs to path, which may be the .img of a pair.
std::string header_file(const std::string& path) {
    const std::unique_ptr<char, void (*)(void*)> name(nifti_findhdrname(path.c_str()), std::free);
    if (!name) fail(path, "there is no NIfTI header (.hdr) beside it");
    return name.get();
}

std::string image_file(const std::string& header) {
    const std::unique_ptr<char, void (*)(void*)> name(
        nifti_findimgname(header.c_str(), NIFTI_FTYPE_NIFTI1_2), std::free);
    if (!name || name.get() == header) fail(header, "there is no NIfTI data file (.img) beside it");
    return name.get();
}

// The first bytes of a file, through gzip where it is gzipped.
std::vector<std::byte> first_bytes(const std::string& path, unsigned count) {
    const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
    if (!file) fail(path, "cannot be opened");
    std::vector<std::byte> bytes(count);
    const int got = gzread(file.get(), bytes.data(), count);
    bytes.resize(static_cast<size_t>(std::max(got, 0)));
    return bytes;
}

bool is_gzipped(const std::string& path) {
    const VoxelBytes bytes = VoxelBytes::map(path, 0, std::min<uint64_t>(file_size(path), 2));
    return bytes.span().size() == 2 && bytes.span()[0] == std::byte{0x1f} &&
           bytes.span()[1] == std::byte{0x8b};
}

std::optional<VoxelType> voxel_type(int datatype) {
    switch (datatype) {
        case NIFTI_TYPE_UINT8:
            return VoxelType::u8;
        case NIFTI_TYPE_INT8:
            return VoxelType::i8;
        case NIFTI_TYPE_UINT16:
            return VoxelType::u16;
        case NIFTI_TYPE_INT16:
            return VoxelType::i16;
        case NIFTI_TYPE_UINT32:
            return VoxelType::u32;
        case NIFTI_TYPE_INT32:
            return VoxelType::i32;
        case NIFTI_TYPE_FLOAT32:
            return VoxelType::f32;
        case NIFTI_TYPE_FLOAT64:
            return VoxelType::f64;
        default:
            return std::nullopt;
    }
}

// Either header, in native byte order.
template <class Header>
void check_header(const std::string& path, const Header& header) {
    const int64_t rank = header.dim[0];
    if (rank < 1 || rank > 7) fail(path, "dim[0]: expected 1 to 7 dimensions, found {}", rank);
    for (int64_t axis = 1; axis <= rank; ++axis)
        if (header.dim[axis] < 1 || static_cast<int64_t>(header.dim[axis]) > UINT32_MAX)
            fail(path, "dim[{}]: expected 1 to 4294967295 voxels, found {}", axis,
                 static_cast<int64_t>(header.dim[axis]));
    for (int64_t axis = 5; axis <= rank; ++axis)
        if (header.dim[axis] != 1)
            fail(
                path,
                "{} values per voxel along dimension {}; only scalar volumes, with time as the 4th "
                "dimension, can be read",
                static_cast<int64_t>(header.dim[axis]), axis);
    if (!voxel_type(header.datatype))
        fail(path,
             "expected a scalar NIfTI datatype of 8, 16 or 32 bits, float or double, found {} ({})",
             header.datatype, nifti_datatype_string(header.datatype));
    const auto offset = static_cast<double>(header.vox_offset);
    const bool one_file = header.magic[1] == '+';
    const double least = one_file ? sizeof(Header) + 4 : 0;
    if (!(offset >= least && offset < 1e9) || offset != std::floor(offset))
        fail(path, "vox_offset: expected a whole number from {} on, found {}", least, offset);
}

void take_image(NiftiFile& file, nifti_image* image, bool one_file) {
    if (image == nullptr) fail(file.header, "libnifti rejects the NIfTI header");
    file.image.reset(image);
    file.offset = static_cast<uint64_t>(image->iname_offset);
    file.data = one_file ? file.header : image_file(file.header);
}

// Checks a swapped copy where needed; libnifti wants the header as it lies in the file.
template <class Header>
void read_header(NiftiFile& file, const std::vector<std::byte>& bytes, bool swapped, int version,
                 std::string_view magic, nifti_image* (*convert)(Header, const char*)) {
    Header header, native;
    if (bytes.size() < sizeof(Header))
        fail(file.header, "expected a NIfTI header of {} bytes, found {}", sizeof(Header),
             bytes.size());
    std::memcpy(&header, bytes.data(), sizeof(Header));
    const std::string_view found(header.magic, 4);
    if (found[0] != 'n' || (found[1] != '+' && found[1] != 'i') || found.substr(2) != magic)
        fail(file.header, "expected a NIfTI-{} header, found magic {} (Analyze 7.5 is not read)",
             version, quoted(found));
    native = header;
    if (swapped) swap_nifti_header(&native, version);
    check_header(file.header, native);
    take_image(file, convert(header, nullptr), header.magic[1] == '+');
}

NiftiFile open_nifti(const std::string& path) {
    nifti_set_debug_level(0);
    NiftiFile file;
    file.header = header_file(path);
    const auto bytes = first_bytes(file.header, sizeof(nifti_2_header));
    uint32_t size = 0;
    if (bytes.size() >= sizeof(size)) std::memcpy(&size, bytes.data(), sizeof(size));
    const bool swapped = size != sizeof(nifti_1_header) && size != sizeof(nifti_2_header);
    if (swapped) size = __builtin_bswap32(size);
    using namespace std::string_view_literals;
    if (size == sizeof(nifti_1_header))
        read_header(file, bytes, swapped, 1, "1\0"sv, nifti_convert_n1hdr2nim);
    else if (size == sizeof(nifti_2_header))
        read_header(file, bytes, swapped, 2, "2\0"sv, nifti_convert_n2hdr2nim);
    else
        fail(path, "expected a NIfTI header (its first number is 348 or 540), found none");
    return file;
}

std::string length_units(int code) {
    if (code == NIFTI_UNITS_METER) return "m";
    if (code == NIFTI_UNITS_MM) return "mm";
    return code == NIFTI_UNITS_MICRON ? "um" : "";
}

// sform, else qform, else the grid spacings alone: as nibabel chooses.
void set_world(Volume& volume, const nifti_image& image) {
    const nifti_dmat44& matrix = image.sform_code > 0 ? image.sto_xyz : image.qto_xyz;
    const bool placed = image.sform_code > 0 || image.qform_code > 0;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            volume.affine.m[row][column] = matrix.m[row][column];
    for (int64_t axis = image.ndim; axis < 3; ++axis)
        if (!placed) volume.affine.m[axis][axis] = 1;  // a picture's missing axis has no spacing
    if (placed) volume.space = Space::ras;
    volume.length_units = length_units(image.xyz_units);
}

uint32_t side(const nifti_image& image, int64_t axis) {
    return axis <= image.ndim ? static_cast<uint32_t>(image.dim[axis]) : 1;
}

}  // namespace

OpenedFile open_nifti(const std::string& path, const LoadOptions& options) {
    if (options.big_endian)
        fail(path, "NIfTI files know their byte order; leave out the endian option");
    const NiftiFile file = open_nifti(path);
    const nifti_image& image = *file.image;
    Volume volume;
    volume.name = path;
    volume.dims = {side(image, 1), side(image, 2), side(image, 3)};
    volume.type = *voxel_type(image.datatype);
    set_time(volume, side(image, 4), options);
    set_world(volume, image);
    if (image.scl_slope != 0) {
        volume.slope = image.scl_slope;
        volume.intercept = image.scl_inter;
    }
    DataSource source{.files = {file.data}};
    const bool native = image.byteorder == nifti_short_order();
    source.big_endian = native == (std::endian::native == std::endian::big);
    if (is_gzipped(file.data)) {
        source.encoding = Encoding::compressed;
        source.skip_inflated = file.offset;
    } else {
        source.offset = file.offset;
    }
    return {std::move(volume), std::move(source)};
}

}  // namespace isorast
