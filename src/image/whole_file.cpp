// SPDX-License-Identifier: MIT
// Files that appear whole or not at all.
#include "image/whole_file.h"

#include <fmt/format.h>
#include <isorast/error.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace isorast {

namespace fs = std::filesystem;

WholeFile::WholeFile(std::string path) : path_(std::move(path)) {
    std::error_code ignored;
    const bool in_place = fs::exists(path_, ignored) && !fs::is_regular_file(path_, ignored);
    written_path_ = in_place ? path_ : fmt::format("{}.{}.tmp", path_, getpid());
    file_ = std::fopen(written_path_.c_str(), "wb");
    if (!file_) fail(errno);
}

WholeFile::~WholeFile() {
    if (!file_) return;
    std::fclose(file_);
    std::error_code ignored;
    if (written_path_ != path_) fs::remove(written_path_, ignored);
}

void WholeFile::write(const void* data, size_t bytes) {
    if (std::fwrite(data, 1, bytes, file_) != bytes) fail(errno);
}

void WholeFile::finish() {
    FILE* file = std::exchange(file_, nullptr);
    int error = std::fclose(file) != 0 ? errno : 0;
    if (written_path_ == path_ && error == 0) return;
    if (error == 0 && std::rename(written_path_.c_str(), path_.c_str()) == 0) return;
    if (error == 0) error = errno;
    std::error_code ignored;
    if (written_path_ != path_) fs::remove(written_path_, ignored);
    fail(error);
}

void WholeFile::fail(int error) const {
    throw Error(fmt::format("{}: cannot be written: {}", path_, std::strerror(error)));
}

}  // namespace isorast
