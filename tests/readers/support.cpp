// SPDX-License-Identifier: MIT
// What the reader tests share: small files in a scratch folder, packing, and the errors of hostile
// ones.
#include "support.h"

#include <isorast/error.h>
#include <unistd.h>
#include <zlib.h>

#include <chrono>
#include <fstream>

namespace isorast::test {

namespace fs = std::filesystem;

Scratch::Scratch() {
    std::string name = (fs::temp_directory_path() / "isorast-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no scratch folder: " + name);
    folder_ = name;
}

Scratch::~Scratch() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

std::string Scratch::write(const std::string& name, const std::string& content) const {
    // Removed first: some file systems wait for the disk when an old file is written over.
    fs::remove(folder_ / name);
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return path(name);
}

namespace {

std::string deflated(const std::string& bytes, int window_bits) {
    z_stream stream{};
    deflateInit2(&stream, 6, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY);
    std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

// While it lives, this process may grow by 64 MiB of address space and no more.
class MemoryLimit {
public:
    MemoryLimit() {
#ifndef __SANITIZE_ADDRESS__
        getrlimit(RLIMIT_AS, &before_);
        rlimit limit = before_;
        uint64_t pages = 0;
        std::ifstream("/proc/self/statm") >> pages;
        limit.rlim_cur = pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) + (64 << 20);
        setrlimit(RLIMIT_AS, &limit);
#endif
    }
    ~MemoryLimit() {
#ifndef __SANITIZE_ADDRESS__
        setrlimit(RLIMIT_AS, &before_);
#endif
    }

private:
    rlimit before_{};
};

}  // namespace

std::string gzip(const std::string& bytes) {
    return deflated(bytes, 15 + 16);
}
std::string zlib(const std::string& bytes) {
    return deflated(bytes, 15);
}

void expect_affine(const Volume& volume, const std::array<std::array<double, 4>, 3>& expected,
                   double tolerance) {
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            EXPECT_NEAR(volume.affine.m[row][column], expected[row][column], tolerance)
                << volume.name << ": affine row " << row << ", column " << column;
}

std::string error_of(const std::string& path, const LoadOptions& options) {
    std::string message;
    const auto start = std::chrono::steady_clock::now();
    try {
        const MemoryLimit limit;
        load_volume(path, options);
    } catch (const Error& error) {
        message = error.what();
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    EXPECT_FALSE(message.empty()) << path << " loads, but should not";
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_NE(message.find(path), std::string::npos) << message;
    EXPECT_EQ(message.find("memory"), std::string::npos) << message;
    EXPECT_LT(seconds.count(), 1.0) << message;
    return message;
}

std::optional<std::string> data_folder() {
    const char* given = std::getenv("ISORAST_DATA");
    const fs::path folder = given != nullptr
                                ? fs::path(given)
                                : fs::path(ISORAST_SOURCE_DIR) / ".." / "shared" / "data";
    if (!fs::is_directory(folder)) return std::nullopt;
    return folder.string();
}

}  // namespace isorast::test
