// SPDX-License-Identifier: MIT
// Where voxel bytes live: owned, mapped from a file, or borrowed.
#include <fcntl.h>
#include <fmt/format.h>
#include <isorast/error.h>
#include <isorast/volume.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace isorast {
namespace {

// A descriptor for reading that closes itself; the mapping outlives it.
struct OpenFile {
    explicit OpenFile(const std::string& path)
        : descriptor(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (descriptor < 0)
            throw Error(fmt::format("{}: cannot be opened: {}", path, std::strerror(errno)));
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    ~OpenFile() { close(descriptor); }
    int descriptor;
};

}  // namespace

VoxelBytes VoxelBytes::map(const std::string& path, uint64_t offset, uint64_t size) {
    const OpenFile file(path);
    struct stat status{};
    if (fstat(file.descriptor, &status) != 0 || !S_ISREG(status.st_mode))
        throw Error(fmt::format("{}: is not a regular file", path));
    const auto file_size = static_cast<uint64_t>(status.st_size);
    if (offset > file_size || size > file_size - offset)
        throw Error(fmt::format("{}: expected {} bytes from byte {} on, found {} in the whole file",
                                path, size, offset, file_size));
    VoxelBytes bytes;
    if (size == 0) return bytes;  // mmap refuses empty ranges

    // Mappings start on page boundaries: map from the page that holds the first byte.
    const auto page = static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
    const uint64_t lead = offset % page;
    void* mapping = mmap(nullptr, lead + size, PROT_READ, MAP_PRIVATE, file.descriptor,
                         static_cast<off_t>(offset - lead));
    if (mapping == MAP_FAILED)
        throw Error(fmt::format("{}: {} bytes cannot be mapped into memory: {}", path, size,
                                std::strerror(errno)));
    bytes.mapping_ = mapping;
    bytes.mapping_size_ = lead + size;
    bytes.span_ = {static_cast<const std::byte*>(mapping) + lead, size};
    return bytes;
}

VoxelBytes VoxelBytes::own(std::vector<std::byte> owned) {
    VoxelBytes bytes;
    bytes.owned_ = std::move(owned);
    bytes.span_ = bytes.owned_;
    return bytes;
}

VoxelBytes VoxelBytes::borrow(std::span<const std::byte> borrowed) {
    VoxelBytes bytes;
    bytes.span_ = borrowed;
    return bytes;
}

// A moved-from VoxelBytes is empty; a moved vector keeps its heap block, so the span stays right.
VoxelBytes::VoxelBytes(VoxelBytes&& other) noexcept
    : span_(std::exchange(other.span_, {})),
      owned_(std::exchange(other.owned_, {})),
      mapping_(std::exchange(other.mapping_, nullptr)),
      mapping_size_(std::exchange(other.mapping_size_, 0)) {}

VoxelBytes& VoxelBytes::operator=(VoxelBytes&& other) noexcept {
    VoxelBytes taken(std::move(other));
    std::swap(span_, taken.span_);
    std::swap(owned_, taken.owned_);
    std::swap(mapping_, taken.mapping_);
    std::swap(mapping_size_, taken.mapping_size_);
    return *this;
}

VoxelBytes::~VoxelBytes() {
    if (mapping_ != nullptr) munmap(mapping_, mapping_size_);
}

}  // namespace isorast
