// SPDX-License-Identifier: MIT
// Truncated, inconsistent and oversized files. Each gives one clear error, at once, without
// allocating what its header only claims (see error_of). Files with random damage give an error or
// a volume, never a crash.
#include <fmt/format.h>
#include <isorast/error.h>

#include <cmath>
#include <random>

#include "nifti_file.h"
#include "support.h"

namespace isorast::test {
namespace {

struct Hostile {
    std::string content;
    const char* says;  // part of the message
};

void expect_errors(const std::string& name, const std::vector<Hostile>& files) {
    EXPECT_GE(files.size(), 25u);
    const Scratch scratch;
    scratch.write("data.raw", std::string(24, 'x'));
    scratch.write("empty.raw", "");
    scratch.write("noise.gz", "\x1f\x8b\x08 this is not deflated");
    for (const Hostile& file : files) {
        const std::string message = error_of(scratch.write(name, file.content));
        EXPECT_NE(message.find(file.says), std::string::npos)
            << "expected \"" << file.says << "\" in: " << message;
    }
}

// Every shorter version of a good file is an error.
void expect_errors_when_cut(const std::string& name, const std::string& content) {
    const Scratch scratch;
    EXPECT_GT(load_volume(scratch.write(name, content)).voxel_count(), 0u);
    const size_t step = std::max<size_t>(1, content.size() / 200);
    for (size_t size = 0; size < content.size(); size += step)
        error_of(scratch.write(name, content.substr(0, size)));
    error_of(scratch.write(name, content.substr(0, content.size() - 1)));
}

void load_damaged(const std::string& name, const std::string& content) {
    const Scratch scratch;
    std::mt19937 random(1);
    for (int round = 0; round < 1500; ++round) {
        std::string damaged = content;
        for (uint32_t count = 1 + random() % 4; count > 0; --count) {
            const size_t at = random() % damaged.size();
            if (random() % 4 == 0)
                damaged.erase(at, 1 + random() % 8);
            else
                damaged[at] = static_cast<char>(random() % 3 == 0 ? "09-.\n #"[random() % 7]
                                                                  : random() % 256);
            if (damaged.empty()) damaged.push_back('x');
        }
        try {
            const Volume volume = load_volume(scratch.write(name, damaged));
            EXPECT_EQ(volume.bytes.span().size(), volume.byte_count());
        } catch (const Error& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        }
    }
}

const std::string VOXELS(24, 'x');

// A NRRD file of 4x3x2 bytes with one field changed, added, or (value "") left out.
std::string nrrd(const std::string& field, const std::string& value,
                 const std::string& data = VOXELS) {
    std::vector<std::pair<std::string, std::string>> fields{
        {"type", "uchar"}, {"dimension", "3"}, {"sizes", "4 3 2"}, {"encoding", "raw"}};
    bool changed = false;
    for (auto& [name, content] : fields) {
        if (name == field) content = value;
        changed = changed || name == field;
    }
    if (!changed) fields.emplace_back(field, value);
    std::string text = "NRRD0004\n";
    for (const auto& [name, content] : fields)
        if (!content.empty()) text += fmt::format("{}: {}\n", name, content);
    return text + "\n" + data;
}

TEST(Hostile, Nrrd) {
    const std::string tiny_gzip = gzip(VOXELS);
    expect_errors(
        "a.nrrd",
        {
            {"NRRD", "NRRD0001"},
            {"NRRD0009x\n", "NRRD0001"},
            {"PNG\n", "NRRD0001"},
            {"NRRD0004\n", "no empty line"},
            {"NRRD0004\ntype: uchar", "no empty line"},
            {"NRRD0004\ntype uchar\n\n", "field: value"},
            {"NRRD0004\n\n", "does not give"},
            {std::string("NRRD0004\n\0\0\0\xff\xfe\n\n", 16), "field: value"},
            {nrrd("type", ""), "\"type\""},
            {nrrd("type", "int64"), "scalar NRRD type"},
            {nrrd("type", "block"), "scalar NRRD type"},
            {nrrd("dimension", ""), "\"dimension\""},
            {nrrd("dimension", "4"), "sizes: expected 4"},
            {nrrd("dimension", "0"), "dimension from 1 to 16"},
            {nrrd("dimension", "-3"), "dimension from 1 to 16"},
            {nrrd("dimension", "4000000000"), "dimension from 1 to 16"},
            {nrrd("sizes", ""), "\"sizes\""},
            {nrrd("sizes", "4 3"), "sizes: expected 3"},
            {nrrd("sizes", "4 3 two"), "whole numbers"},
            {nrrd("sizes", "4 3 0"), "whole numbers"},
            {nrrd("sizes", "4 3 -2"), "whole numbers"},
            {nrrd("sizes", "4 3 2.5"), "whole numbers"},
            {nrrd("sizes", "4 3 99999999999"), "whole numbers"},
            {nrrd("sizes", "4 3 3"), "expected 36 bytes"},
            {nrrd("sizes", "4 3 1"), "expected 12 bytes"},
            {nrrd("sizes", "100000 100000 100000"), "expected 1000000000000000 bytes"},
            {nrrd("sizes", "4294967295 4294967295 4294967295"), "63 bits"},
            {nrrd("sizes", "4294967295 4294967295 1"), "63 bits"},
            {nrrd("encoding", ""), "\"encoding\""},
            {nrrd("encoding", "bzip2"), "encoding raw, gzip or ascii"},
            {nrrd("encoding", "hex"), "encoding raw, gzip or ascii"},
            {nrrd("encoding", "gzip"), "corrupt"},
            {nrrd("encoding", "gzip", ""), "expected data from byte"},
            {nrrd("encoding", "gzip", tiny_gzip.substr(0, tiny_gzip.size() - 4)), "cut off"},
            {nrrd("encoding", "gzip", tiny_gzip.substr(0, 12)), "cut off"},
            {nrrd("encoding", "gzip", tiny_gzip + "rest"), "follow the compressed data"},
            {nrrd("encoding", "gzip", gzip(VOXELS + "x")), "found more"},
            {nrrd("encoding", "gzip", gzip(VOXELS.substr(1))),
             "expected 24 bytes in the compressed data"},
            {nrrd("encoding", "gzip\nbyte skip: -1", tiny_gzip), "byte skip -1"},
            {nrrd("encoding", "gzip\nbyte skip: 9223372036854775807", tiny_gzip), "cannot hold"},
            {nrrd("encoding", "ascii", "1 2 3"), "cannot hold"},
            {nrrd("encoding", "ascii",
                  "1 2 3                                                          "),
             "expected 24 numbers, found 3"},
            {nrrd("encoding", "ascii", text_of_values(voxels<uint8_t>(25))), "found more"},
            {nrrd("encoding", "ascii", text_of_values(voxels<uint8_t>(23)) + "256"), "number 24"},
            {nrrd("encoding", "ascii", text_of_values(voxels<uint8_t>(23)) + "-1"), "number 24"},
            {nrrd("encoding", "ascii", text_of_values(voxels<uint8_t>(23)) + "x"), "number 24"},
            {nrrd("type", "short"), "endian"},
            {nrrd("type", "short\nendian: middle"), "endian little or big"},
            {nrrd("type", "uchar\nTYPE: uchar"), "twice"},
            {nrrd("byte skip", "-2"), "byteskip: expected"},
            {nrrd("byte skip", "25"), "expected data from byte"},
            {nrrd("byte skip", "18446744073709551615"), "byteskip: expected"},
            {nrrd("byte skip", "9223372036854775807"), "expected data from byte"},
            {nrrd("line skip", "-1"), "lineskip: expected"},
            {nrrd("line skip", "9223372036854775807"), "lines before the data"},
            {nrrd("spacings", "1 2"), "spacings: expected 3"},
            {nrrd("spacings", "1 2 x"), "expected a number"},
            {nrrd("spacings", "1 0 1"), "spacing 1 x 0 x 1; give the spacing"},
            {nrrd("spacings", "inf 1 1"), "spacing inf x 1 x 1; give the spacing"},
            {nrrd("space directions", "(1,0,0) (0,1,0)"), "expected 3 vectors"},
            {nrrd("space directions", "(1,0,0) (0,1,0) (0,0"), "expected vectors"},
            {nrrd("space directions", "(1,0,0) (0,1,0) (0,0,0,1)"), "2 or 3 numbers"},
            {nrrd("space directions", "(1,0,0) (0,1,0) (0,2,0)"),
             "directions (1, 0, 0), (0, 1, 0) and (0, 2, 0), which lie in one plane; correct them"},
            {nrrd("space directions", "(1,0) (0,1,0) (0,0,1)"),
             "expected vectors of 2 numbers, found 3 in \"(1,0) (0,1,0) (0,0,1)\""},
            {nrrd("space dimension: 3\nspace directions", "(1,0) (0,1,0) (0,0,1)"),
             "expected vectors of 3 numbers, found 2 in"},
            {nrrd("space: RAS\nspace directions", "(1,0,0) (0,1) (0,0,1)"),
             "expected vectors of 3 numbers, found 2 in"},
            {nrrd("space dimension: three\nspace directions", "(1,0,0) (0,1,0) (0,0,1)"),
             "space dimension: expected a whole number, found \"three\""},
            {"NRRD0004\ntype: uchar\ndimension: 2\nsizes: 6 4\nencoding: raw\n"
             "space directions: (1,0,0) (2,0,0)\n\n" +
                 VOXELS,
             "expected two that span a plane, found \"(1,0,0) (2,0,0)\""},
            {nrrd("space directions", "(1,0,0) (0,1,0) (a,b,c)"), "expected a number"},
            {nrrd("space directions", "(1,0,0) none none"), "holds 3 values per voxel"},
            {nrrd("space origin", "1 2 3"), "expected vectors"},
            {nrrd("space origin", "(1,2,3) (4,5,6)"), "expected one vector"},
            {nrrd("space origin", "(1,inf,3)"), "origin is not finite: 1, inf, 3"},
            {nrrd("space", "right-anterior-superior-time"), "include time"},
            {nrrd("kinds", "RGB-color domain domain"), "4 values per voxel"},
            {nrrd("kinds", "domain domain 2-vector"), "2 values per voxel"},
            {nrrd("kinds", "domain domain"), "kinds: expected 3"},
            {"NRRD0004\ntype: uchar\ndimension: 1\nsizes: 24\nencoding: raw\n\n" + VOXELS,
             "axes in space"},
            {"NRRD0004\ntype: uchar\ndimension: 5\nsizes: 1 2 3 2 2\nencoding: raw\n\n" + VOXELS,
             "found 5 in space"},
            {"NRRD0004\ntype: uchar\ndimension: 4\nsizes: 3 2 2 2\nkinds: vector domain domain "
             "domain\n"
             "encoding: raw\n\n" +
                 VOXELS,
             "3 values per voxel"},
        });
}

TEST(Hostile, NrrdDetached) {
    const auto detached = [](const std::string& fields) {
        return "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 4 3 2\n" + fields;
    };
    expect_errors(
        "a.nhdr",
        {
            {detached("encoding: raw\ndata file: missing.raw\n"), "no such file"},
            {detached("encoding: raw\ndata file: .\n"), "directory"},
            {detached("encoding: raw\ndata file: /dev/zero\n") + std::string(200, '\n'),
             "regular file"},
            {detached("encoding: raw\ndata file: empty.raw\n"), "empty"},
            {detached("encoding: raw\ndata file:\n"), "directory"},
            {detached("encoding: raw\ndata file: data.raw\nbyte skip: 1\n"),
             "expected 24 bytes from byte 1"},
            {detached("encoding: raw\nbyte skip: 24\ndata file: data.raw\n"),
             "expected data from byte 24"},
            {detached("encoding: raw\nline skip: 1\ndata file: data.raw\n"),
             "expected data from byte"},
            {detached("encoding: raw\nline skip: 2\ndata file: data.raw\n"), "expected 2 lines"},
            {detached("encoding: gzip\ndata file: data.raw\n"), "corrupt"},
            {detached("encoding: gzip\ndata file: noise.gz\n"), "compressed data"},
            {detached("encoding: ascii\ndata file: data.raw\n"), "cannot hold"},
            {detached("encoding: raw\ndata file: LIST\n"), "names no data file"},
            {detached("encoding: raw\ndata file: LIST\ndata.raw\n\nmissing.raw\n"),
             "expected 12 bytes"},
            {detached("encoding: raw\ndata file: LIST\nmissing.raw\nmissing.raw\n"),
             "no such file"},
            {detached("encoding: raw\ndata file: LIST\na\nb\nc\nd\ne\n"), "equal size"},
            {detached("encoding: raw\ndata file: x%d.raw 1 2 1\n"), "no such file"},
            {detached("encoding: raw\ndata file: x%d.raw 1 2 0\n"), "does not lead"},
            {detached("encoding: raw\ndata file: x%d.raw 2 1 1\n"), "does not lead"},
            {detached("encoding: raw\ndata file: x%d.raw 1 2 -5\n"), "does not lead"},
            {detached("encoding: raw\ndata file: x%d.raw 8 5 10\n"),
             "step 10 does not lead from 8 to 5"},
            {detached("encoding: raw\ndata file: x%d.raw 1 2000000000 1\n"), "at most"},
            {detached("encoding: raw\ndata file: x%d.raw -2147483648 2147483647 1\n"), "at most"},
            {detached("encoding: raw\ndata file: x%d.raw 1 99999999999 1\n"), "whole number"},
            {detached("encoding: raw\ndata file: x%s.raw 1 2 1\n"), "must hold one number"},
            {detached("encoding: raw\ndata file: x%n%d.raw 1 2 1\n"), "must hold one number"},
            {detached("encoding: raw\ndata file: x%d%d.raw 1 2 1\n"), "must hold one number"},
            {detached("encoding: raw\ndata file: x%999999999d.raw 1 2 1\n"),
             "must hold one number"},
            {detached("encoding: raw\ndata file: x\x01\x02\x7f\n"), "no such file"},
        });
}

std::string meta(const std::string& name, const std::string& value,
                 const std::string& data = VOXELS) {
    std::vector<std::pair<std::string, std::string>> fields{
        {"NDims", "3"}, {"DimSize", "4 3 2"}, {"ElementType", "MET_UCHAR"}};
    std::string file = "LOCAL";
    bool changed = name == "ElementDataFile";
    if (changed) file = value;
    for (auto& [field, content] : fields) {
        if (field == name) content = value;
        changed = changed || field == name;
    }
    if (!changed) fields.emplace_back(name, value);
    std::string text;
    for (const auto& [field, content] : fields)
        if (!content.empty()) text += fmt::format("{} = {}\n", field, content);
    return text + "ElementDataFile = " + file + "\n" + data;
}

TEST(Hostile, MetaImage) {
    const std::string packed = zlib(VOXELS);
    expect_errors(
        "a.mhd",
        {
            {"NDims = 3\n", "ElementDataFile"},
            {"ElementDataFile = LOCAL\n" + VOXELS, "\"NDims\""},
            {"NDims = 3\nElementDataFile =\n", "\"ElementDataFile\""},
            {"hello\n", "Name = value"},
            {std::string("\0\0\0\0\x01\x02", 6), "Name = value"},
            {meta("NDims", ""), "\"NDims\""},
            {meta("NDims", "0"), "NDims 2, 3 or 4"},
            {meta("NDims", "1"), "NDims 2, 3 or 4"},
            {meta("NDims", "5"), "NDims 2, 3 or 4"},
            {meta("NDims", "-1"), "NDims 2, 3 or 4"},
            {meta("NDims", "1000000000"), "NDims 2, 3 or 4"},
            {meta("NDims", "4"), "DimSize: expected 4"},
            {meta("NDims", "2"), "DimSize: expected 2"},
            {meta("DimSize", ""), "\"DimSize\""},
            {meta("DimSize", "4 3"), "DimSize: expected 3"},
            {meta("DimSize", "4 3 x"), "whole numbers"},
            {meta("DimSize", "4 3 0"), "whole numbers"},
            {meta("DimSize", "4 3 -2"), "whole numbers"},
            {meta("DimSize", "4 3 3"), "expected 36 bytes"},
            {meta("DimSize", "4 3 1"), "expected 12 bytes"},
            {meta("DimSize", "100000 100000 100000"), "expected 1000000000000000 bytes"},
            {meta("DimSize", "4294967295 4294967295 4294967295"), "63 bits"},
            {meta("NDims", "3\nNDims = 3"), "twice"},
            {meta("ElementType", ""), "\"ElementType\""},
            {meta("ElementType", "MET_LONG_LONG"), "scalar ElementType"},
            {meta("ElementType", "MET_UCHAR_ARRAY"), "scalar ElementType"},
            {meta("ElementType", "MET_SHORT"), "expected 48 bytes"},
            {meta("ElementNumberOfChannels", "3"), "channels"},
            {meta("ElementNumberOfChannels", "0"), "channels"},
            {meta("ElementSpacing", "1 2"), "ElementSpacing: expected 3"},
            {meta("ElementSpacing", "1 2 nan"), "finite number"},
            {meta("ElementSpacing", "1 2 x"), "finite number"},
            {meta("ElementSpacing", "1 2 0"), "affine"},
            {meta("TransformMatrix", "1 0 0 0 1 0"), "TransformMatrix: expected 9"},
            {meta("TransformMatrix", "1 0 0 0 1 0 0 1 0"), "affine"},
            {meta("TransformMatrix", "0 0 0 0 0 0 0 0 0"), "affine"},
            {meta("Offset", "1 2 3 4"), "Offset: expected 3"},
            {meta("HeaderSize", "-2"), "HeaderSize: expected"},
            {meta("HeaderSize", "x"), "HeaderSize: expected"},
            {meta("HeaderSize", "9223372036854775807"), "expected data from byte"},
            {meta("HeaderSize", "5"), "expected 24 bytes from byte 5"},
            {meta("DimSize", "40 30 20\nHeaderSize = -1"), "expected at least 24000 bytes"},
            {meta("HeaderSize", "-1\nCompressedData = True", packed), "HeaderSize -1"},
            {meta("CompressedData", "True"), "corrupt"},
            {meta("CompressedData", "True", ""), "expected data from byte"},
            {meta("CompressedData", "True", packed.substr(0, packed.size() - 1)), "cut off"},
            {meta("CompressedData", "True", packed + "rest"), "follow the compressed data"},
            {meta("CompressedData", "True", zlib(VOXELS + "x")), "found more"},
            {meta("CompressedData", "True", zlib("x")), "found 1"},
            {meta("DimSize", "1000 1000 1000\nCompressedData = True", packed), "cannot hold"},
            {meta("BinaryData", "False", "1 2 3"), "cannot hold"},
            {meta("BinaryData", "False", text_of_values(voxels<uint8_t>(25))), "found more"},
            {meta("ElementDataFile", "missing.raw"), "no such file"},
            {meta("ElementDataFile", "."), "directory"},
            {meta("ElementDataFile", "empty.raw"), "empty"},
            {meta("ElementDataFile", "LIST", ""), "names no data file"},
            {meta("ElementDataFile", "LIST", "data.raw\ndata.raw\n"), "expected 12 bytes"},
            {meta("ElementDataFile", "LIST", "missing.raw\n"), "no such file"},
            {meta("ElementDataFile", "x%d.raw 1 2000000000 1"), "at most"},
            {meta("ElementDataFile", "x%s.raw 1 2 1"), "must hold one number"},
        });
}

std::string nifti(void (*damage)(NiftiFile&), int version = 1,
                  const std::string& data = std::string(48, 'x')) {
    NiftiFile file;
    file.version = version;
    damage(file);
    return file.header() + data;
}

std::vector<Hostile> damaged_nifti(int version) {
    const auto with = [&](void (*damage)(NiftiFile&)) { return nifti(damage, version); };
    return {
        {with([](NiftiFile& f) { f.sizeof_hdr = 1; }), "348 or 540"},
        {with([](NiftiFile& f) { f.sizeof_hdr = -1; }), "348 or 540"},
        {with([](NiftiFile& f) { f.magic = "xyz"; }), "magic"},
        {with([](NiftiFile& f) { f.magic = std::string_view("\0\0\0", 3); }), "magic"},
        {with([](NiftiFile& f) { f.magic = "n+9"; }), "magic"},
        {with([](NiftiFile& f) { f.magic = f.version == 1 ? "ni1" : "ni2"; }), ".img"},
        {with([](NiftiFile& f) { f.dim[0] = 0; }), "dim[0]"},
        {with([](NiftiFile& f) { f.dim[0] = 8; }), "dim[0]"},
        {with([](NiftiFile& f) { f.dim[0] = -1; }), "dim[0]"},
        {with([](NiftiFile& f) { f.dim[0] = 30000; }), "dim[0]"},
        {with([](NiftiFile& f) { f.dim[1] = 0; }), "dim[1]"},
        {with([](NiftiFile& f) { f.dim[2] = 0; }), "dim[2]"},
        {with([](NiftiFile& f) { f.dim[3] = -2; }), "dim[3]"},
        {with([](NiftiFile& f) { f.dim[3] = 3; }), "expected 72 bytes"},
        {with([](NiftiFile& f) { f.dim[3] = 1; }), "expected 24 bytes"},
        {with([](NiftiFile& f) { f.dim = {3, 30000, 30000, 30000, 1, 1, 1, 1}; }),
         "expected 54000000000000 bytes"},
        {with([](NiftiFile& f) { f.dim = {4, 4, 3, 2, 32767, 1, 1, 1}; }), "time steps"},
        {with([](NiftiFile& f) { f.dim = {5, 4, 3, 2, 1, 3, 1, 1}; }), "3 values per voxel"},
        {with([](NiftiFile& f) { f.dim = {7, 4, 3, 2, 1, 1, 1, 2}; }), "2 values per voxel"},
        {with([](NiftiFile& f) { f.datatype = 0; }), "datatype"},
        {with([](NiftiFile& f) { f.datatype = 1; }), "datatype"},
        {with([](NiftiFile& f) { f.datatype = 32; }), "COMPLEX64"},
        {with([](NiftiFile& f) { f.datatype = 128; }), "RGB"},
        {with([](NiftiFile& f) { f.datatype = 1024; }), "INT64"},
        {with([](NiftiFile& f) { f.datatype = 1536; }), "FLOAT128"},
        {with([](NiftiFile& f) { f.datatype = 2304; }), "RGBA"},
        {with([](NiftiFile& f) { f.datatype = 12345; }), "datatype"},
        {with([](NiftiFile& f) { f.vox_offset = 0; }), "vox_offset"},
        {with([](NiftiFile& f) { f.vox_offset = -352; }), "vox_offset"},
        {with([](NiftiFile& f) { f.vox_offset = 1e12; }), "vox_offset"},
        {with([](NiftiFile& f) { f.vox_offset = 1e6; }), "expected data from byte"},
        {with([](NiftiFile& f) { f.vox_offset = 560; }), "expected"},
        {with([](NiftiFile& f) { f.sform_code = 1; }), "affine"},
        {with([](NiftiFile& f) {
             f.sform_code = 1;
             f.srow.fill(NAN);
         }),
         "affine"},
        {with([](NiftiFile& f) {
             f.sform_code = 1;
             f.srow = {1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0};
         }),
         "affine"},
        {with([](NiftiFile& f) {
             f.sform_code = 1;
             f.srow = {1, 0, 0, INFINITY, 0, 1, 0, 0, 0, 0, 1, 0};
         }),
         "affine"},
    };
}

// libnifti's own words on stderr must not reach the user.
TEST(Hostile, Nifti) {
    ::testing::internal::CaptureStderr();
    for (const int version : {1, 2}) {
        std::vector<Hostile> files = damaged_nifti(version);
        files.push_back({"", "empty"});
        files.push_back({"x", "348 or 540"});
        files.push_back({nifti([](NiftiFile&) {}, version, ""), "expected"});
        files.push_back({nifti([](NiftiFile&) {}, version).substr(0, 340), "header of"});
        files.push_back({nifti([](NiftiFile&) {}, version, std::string(47, 'x')), "found 47"});
        files.push_back({nifti([](NiftiFile&) {}, version, std::string(49, 'x')), "found 49"});
        expect_errors("a.nii", files);
        for (Hostile& file : files)
            file.content = gzip(file.content);
        const Scratch scratch;
        for (const Hostile& file : files)
            error_of(scratch.write("a.nii.gz", file.content));
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(Hostile, NiftiVersion2Sizes) {
    const Scratch scratch;
    error_of(scratch.write(
        "a.nii", nifti([](NiftiFile& f) { f.dim = {3, 100000, 100000, 100000, 1, 1, 1, 1}; }, 2)));
    error_of(scratch.write(
        "a.nii",
        nifti([](NiftiFile& f) { f.dim = {3, 4294967295, 4294967295, 4294967295, 1, 1, 1, 1}; },
              2)));
    error_of(scratch.write(
        "a.nii", nifti([](NiftiFile& f) { f.dim = {3, INT64_MAX, 1, 1, 1, 1, 1, 1}; }, 2)));
    error_of(scratch.write(
        "a.nii", nifti([](NiftiFile& f) { f.dim = {INT64_MAX, 4, 3, 2, 1, 1, 1, 1}; }, 2)));
}

TEST(Hostile, NiftiPairs) {
    const Scratch scratch;
    error_of(scratch.write("alone.img", "x"));
    error_of(scratch.write("alone.hdr", NiftiFile().pair_header()));
    scratch.write("short.img", "x");
    error_of(scratch.write("short.hdr", NiftiFile().pair_header()));
    error_of(scratch.write("header_is_text.hdr", "ENVI\nsamples = 4\n"));
}

TEST(Hostile, CutFiles) {
    const std::string bytes(1000, 'x');
    const std::string sizes = "dimension: 3\nsizes: 10 10 10\ntype: uchar\n";
    expect_errors_when_cut("a.nrrd", "NRRD0004\n" + sizes + "encoding: raw\n\n" + bytes);
    expect_errors_when_cut("a.nrrd", "NRRD0004\n" + sizes + "encoding: gzip\n\n" + gzip(bytes));
    expect_errors_when_cut("a.nrrd", "NRRD0004\n" + sizes + "encoding: ascii\n\n" +
                                         text_of_values(std::vector<uint8_t>(999, 7)) + "7");
    const std::string meta_header = "NDims = 3\nDimSize = 10 10 10\nElementType = MET_UCHAR\n";
    expect_errors_when_cut("a.mha", meta_header + "ElementDataFile = LOCAL\n" + bytes);
    expect_errors_when_cut(
        "a.mha", meta_header + "CompressedData = True\nElementDataFile = LOCAL\n" + zlib(bytes));
    for (const int version : {1, 2}) {
        NiftiFile file;
        file.version = version;
        expect_errors_when_cut("a.nii", file.header() + std::string(48, 'x'));
        expect_errors_when_cut("a.nii.gz", gzip(file.header() + std::string(48, 'x')));
    }
}

TEST(Hostile, DamagedFiles) {
    ::testing::internal::CaptureStderr();
    load_damaged("a.nrrd", nrrd("space directions",
                                "(1,0,0) (0,1,0) (0,0,1)\nspace: LPS\nspace origin: (1,2,3)"));
    load_damaged("a.nrrd", nrrd("encoding", "gzip", gzip(VOXELS)));
    load_damaged("a.nrrd", nrrd("encoding", "ascii", text_of_values(voxels<uint8_t>(24))));
    load_damaged("a.mha", meta("TransformMatrix",
                               "1 0 0 0 1 0 0 0 1\nOffset = 1 2 3\nElementSpacing = 1 2 3"));
    load_damaged("a.mha", meta("CompressedData", "True", zlib(VOXELS)));
    for (const int version : {1, 2}) {
        load_damaged("a.nii", nifti([](NiftiFile&) {}, version));
        load_damaged("a.nii.gz", gzip(nifti([](NiftiFile&) {}, version)));
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace isorast::test
