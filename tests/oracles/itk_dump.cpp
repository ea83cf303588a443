// SPDX-License-Identifier: MIT
// What ITK makes of a volume file, as text for the reader tests: one "name value..." line each for
// dimensions, components, type, affine (in ITK's LPS world) and a hash of the native-endian voxels.
#include <itkImageIOBase.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <vector>

namespace {

itk::ImageIOBase::Pointer reader_of(const char* path) {
    const itk::ImageIOBase::Pointer readers[] = {itk::NrrdImageIO::New().GetPointer(),
                                                 itk::MetaImageIO::New().GetPointer(),
                                                 itk::NiftiImageIO::New().GetPointer()};
    for (const auto& reader : readers)
        if (reader->CanReadFile(path)) return reader;
    return nullptr;
}

// 64-bit FNV-1a over 8-byte words, the last one padded with zeros.
uint64_t fnv1a_of_words(std::vector<char> bytes) {
    bytes.resize((bytes.size() + 7) / 8 * 8);
    uint64_t hash = 14695981039346656037ull;
    for (size_t at = 0; at < bytes.size(); at += 8) {
        uint64_t word;
        std::memcpy(&word, &bytes[at], 8);
        hash = (hash ^ word) * 1099511628211ull;
    }
    return hash;
}

void dump(itk::ImageIOBase& reader, const char* path) {
    reader.SetFileName(path);
    reader.ReadImageInformation();
    const unsigned dimensions = reader.GetNumberOfDimensions();
    itk::ImageIORegion region(dimensions);
    std::printf("dims");
    for (unsigned axis = 0; axis < dimensions; ++axis) {
        region.SetSize(axis, reader.GetDimensions(axis));
        region.SetIndex(axis, 0);
        std::printf(" %zu", static_cast<size_t>(reader.GetDimensions(axis)));
    }
    std::printf("\ncomponents %u\n", reader.GetNumberOfComponents());
    std::printf("type %s\n",
                itk::ImageIOBase::GetComponentTypeAsString(reader.GetComponentType()).c_str());
    std::printf("affine");
    const unsigned spatial = std::min(dimensions, 3u);
    for (unsigned row = 0; row < spatial; ++row) {
        for (unsigned axis = 0; axis < spatial; ++axis)
            std::printf(" %.17g", reader.GetDirection(axis)[row] * reader.GetSpacing(axis));
        std::printf(" %.17g", reader.GetOrigin(row));
    }
    reader.SetIORegion(region);
    std::vector<char> voxels(static_cast<size_t>(reader.GetImageSizeInBytes()));
    reader.Read(voxels.data());
    std::printf("\nhash %016" PRIx64 "\n", fnv1a_of_words(voxels));
}

}  // namespace

int main(int count, char** arguments) {
    try {
        const auto reader = count == 2 ? reader_of(arguments[1]) : nullptr;
        if (!reader) return 2;
        dump(*reader, arguments[1]);
    } catch (const itk::ExceptionObject& error) {
        std::fprintf(stderr, "%s\n", error.GetDescription());
        return 1;
    }
    return 0;
}
