// SPDX-License-Identifier: MIT
// Bounded decompression of gzip and zlib streams.
#pragma once
#include <isorast/volume.h>

#include <memory>

namespace isorast {

// A stream that inflates to `expected` bytes, no more and no less, else throws Error; memory grows
// with what really comes out.
class InflateStream {
public:
    InflateStream(std::string name, VoxelBytes compressed, uint64_t expected);
    ~InflateStream();

    uint64_t position() const { return position_; }
    void skip(uint64_t count);
    void append(uint64_t count, std::vector<std::byte>& out);
    // Skips what is left, and makes sure that nothing follows.
    void finish();

private:
    void require(uint64_t got, uint64_t wanted);
    class Inflater;
    std::string name_;
    VoxelBytes compressed_;
    std::unique_ptr<Inflater> inflater_;
    uint64_t expected_, position_ = 0;
};

}  // namespace isorast
