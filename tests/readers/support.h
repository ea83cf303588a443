// SPDX-License-Identifier: MIT
// What the reader tests share: small files in a scratch folder, packing, and the errors of hostile
// ones.
#pragma once
#include <gtest/gtest.h>
#include <isorast/load.h>
#include <sys/resource.h>

#include <cstring>
#include <filesystem>
#include <string>

namespace isorast::test {

// A folder for one test's files; gone with the object.
class Scratch {
public:
    Scratch();
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    ~Scratch();
    // Writes a file and returns its path.
    std::string write(const std::string& name, const std::string& content) const;
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

private:
    std::filesystem::path folder_;
};

// Values that differ from voxel to voxel, from negative (signed types) to large, fractions for
// floats.
template <class T>
std::vector<T> voxels(size_t count) {
    std::vector<T> values(count);
    for (size_t i = 0; i < count; ++i) {
        const double wave =
            static_cast<double>((i * 2654435761u + 12345) % 100003) / 100003;  // [0, 1)
        if constexpr (std::is_floating_point_v<T>)
            values[i] = static_cast<T>(wave * 200 - 100);
        else
            values[i] = static_cast<T>(std::numeric_limits<T>::min() +
                                       wave * (static_cast<double>(std::numeric_limits<T>::max()) -
                                               std::numeric_limits<T>::min()));
    }
    return values;
}

template <class T>
std::string bytes_of_values(const std::vector<T>& values, bool big_endian = false) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    if (big_endian)
        for (size_t at = 0; at < bytes.size(); at += sizeof(T))
            std::reverse(bytes.begin() + at, bytes.begin() + at + sizeof(T));
    return bytes;
}

template <class T>
std::string text_of_values(const std::vector<T>& values, const char* separator = " ") {
    std::string text;
    char word[40];
    for (const T value : values) {
        if constexpr (std::is_floating_point_v<T>)
            std::snprintf(word, sizeof(word), "%.17g", static_cast<double>(value));
        else
            std::snprintf(word, sizeof(word), "%lld", static_cast<long long>(value));
        text += word;
        text += separator;
    }
    return text;
}

std::string gzip(const std::string& bytes);
std::string zlib(const std::string& bytes);

// Every voxel of the volume is the value expected.
template <class T>
void expect_voxels(const Volume& volume, const std::vector<T>& expected) {
    ASSERT_EQ(volume.bytes.span().size(), expected.size() * sizeof(T));
    EXPECT_EQ(std::memcmp(volume.bytes.span().data(), expected.data(), expected.size() * sizeof(T)),
              0);
}

void expect_affine(const Volume& volume, const std::array<std::array<double, 4>, 3>& expected,
                   double tolerance = 1e-6);

// The message of the Error that loading throws. Checks that it is one line, names the file, comes
// within a second, and that no more than 64 MiB were asked for on the way.
std::string error_of(const std::string& path, const LoadOptions& options = {});

// The folder with real volumes, or nothing.
std::optional<std::string> data_folder();

}  // namespace isorast::test
