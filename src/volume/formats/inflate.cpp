// SPDX-License-Identifier: MIT
// Bounded decompression of gzip and zlib streams.
#include "volume/formats/inflate.h"

#include <zlib.h>

#include <algorithm>
#include <array>

#include "volume/text.h"

namespace isorast {
namespace {

constexpr uint64_t PIECE = 64 << 20;      // most bytes that zlib is handed at once
constexpr uint64_t HIGHEST_RATIO = 1032;  // of deflate: 258 bytes for two bits

}  // namespace

class InflateStream::Inflater {
public:
    Inflater(const std::string& name, std::span<const std::byte> in) : name_(name), in_(in) {
        constexpr int gzip_or_zlib = 15 + 32;
        if (inflateInit2(&stream_, gzip_or_zlib) != Z_OK) fail(name_, "zlib cannot be started");
    }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;
    ~Inflater() { inflateEnd(&stream_); }

    // Fills `out` and returns how much came; less than its size only at the end of the stream.
    uint64_t read(std::span<std::byte> out) {
        uint64_t got = 0;
        while (got < out.size() && !ended_)
            got += read_some(out.subspan(got));
        return got;
    }

private:
    uint64_t read_some(std::span<std::byte> out) {
        const auto in_piece = static_cast<uInt>(std::min<uint64_t>(in_.size(), PIECE));
        const auto out_piece = static_cast<uInt>(std::min<uint64_t>(out.size(), PIECE));
        stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(in_.data()));
        stream_.avail_in = in_piece;
        stream_.next_out = reinterpret_cast<Bytef*>(out.data());
        stream_.avail_out = out_piece;
        const int result = inflate(&stream_, Z_NO_FLUSH);
        in_ = in_.subspan(in_piece - stream_.avail_in);
        const uint64_t got = out_piece - stream_.avail_out;
        if (result == Z_STREAM_END)
            end_member();
        else if (result == Z_BUF_ERROR || (result == Z_OK && in_.empty() && got < out_piece))
            fail(name_,
                 "the compressed data end after {} inflated bytes, in mid-stream; the file is cut "
                 "off",
                 stream_.total_out);
        else if (result != Z_OK)
            fail(name_, "the compressed data are corrupt: {}",
                 stream_.msg != nullptr ? stream_.msg : zError(result));
        return got;
    }

    // A gzip file may hold several members; zero padding may follow the last.
    void end_member() {
        if (in_.size() >= 2 && in_[0] == std::byte{0x1f} && in_[1] == std::byte{0x8b}) {
            inflateReset(&stream_);
            return;
        }
        if (std::any_of(in_.begin(), in_.end(), [](std::byte b) { return b != std::byte{0}; }))
            fail(name_, "{} bytes that are not compressed data follow the compressed data",
                 in_.size());
        ended_ = true;
    }

    const std::string& name_;
    std::span<const std::byte> in_;
    z_stream stream_{};
    bool ended_ = false;
};

InflateStream::InflateStream(std::string name, VoxelBytes compressed, uint64_t expected)
    : name_(std::move(name)), compressed_(std::move(compressed)), expected_(expected) {
    const uint64_t size = compressed_.span().size();
    if (expected / HIGHEST_RATIO > size)
        fail(name_, "expected {} bytes, but {} compressed bytes cannot hold so many", expected,
             size);
    inflater_ = std::make_unique<Inflater>(name_, compressed_.span());
}

InflateStream::~InflateStream() = default;

void InflateStream::require(uint64_t got, uint64_t wanted) {
    position_ += got;
    if (got < wanted)
        fail(name_, "expected {} bytes in the compressed data, found {}", expected_, position_);
}

void InflateStream::skip(uint64_t count) {
    std::vector<std::byte> scratch(64 << 10);
    while (count > 0) {
        const uint64_t piece = std::min<uint64_t>(count, scratch.size());
        require(inflater_->read({scratch.data(), piece}), piece);
        count -= piece;
    }
}

void InflateStream::append(uint64_t count, std::vector<std::byte>& out) {
    while (count > 0) {
        const uint64_t piece = std::min(count, std::max<uint64_t>(PIECE, out.size()));
        const size_t start = out.size();
        out.resize(start + piece);
        require(inflater_->read({out.data() + start, piece}), piece);
        count -= piece;
    }
}

void InflateStream::finish() {
    skip(expected_ - position_);
    std::byte more{};
    if (inflater_->read({&more, 1}) != 0)
        fail(name_, "expected {} bytes in the compressed data, found more", expected_);
}

}  // namespace isorast
