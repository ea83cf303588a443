// SPDX-License-Identifier: MIT
// Bounded decompression of gzip and zlib streams.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace isorast {

// Appends bytes [skip, skip + take) of the inflated stream to `out`. The stream must inflate to
// `expected` bytes, no more and no less, else throws Error; memory grows with what really comes
// out.
void inflate_window(const std::string& name, std::span<const std::byte> compressed,
                    uint64_t expected, uint64_t skip, uint64_t take, std::vector<std::byte>& out);

}  // namespace isorast
