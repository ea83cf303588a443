// SPDX-License-Identifier: MIT
// A file that appears whole or not at all.
#pragma once
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace isorast {

// Written beside its place under another name, and renamed by finish(); without that it is removed.
// Devices and pipes are written in place. Everything throws Error.
class WholeFile {
public:
    explicit WholeFile(std::string path);
    WholeFile(const WholeFile&) = delete;
    WholeFile& operator=(const WholeFile&) = delete;
    ~WholeFile();

    void write(const void* data, size_t bytes);
    template <class T>
    void write(const std::vector<T>& values) {
        write(values.data(), values.size() * sizeof(T));
    }
    void write(const std::string& text) { write(text.data(), text.size()); }
    void finish();

private:
    [[noreturn]] void fail(int error) const;
    std::string path_, written_path_;
    FILE* file_ = nullptr;
};

}  // namespace isorast
