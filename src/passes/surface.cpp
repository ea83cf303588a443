// SPDX-License-Identifier: MIT
// Count, scan, emit. The GPU counts each block's vertices and triangles; the host, which must know
// the sizes anyhow, adds the counts up and cuts the blocks into batches; the GPU then writes the
// vertices and triangles of a batch. A batch's buffers fit any device that can hold one block's
// output and what a layer of blocks needs to find shared vertices.
#include "passes/surface.h"

#include <fmt/format.h>
#include <isorast/error.h>

#include <algorithm>
#include <cstring>

#include "gpu/device.h"
#include "shaders/marching_cubes.h"
#include "surface_count_comp.h"
#include "surface_triangles_comp.h"
#include "surface_vertices_comp.h"

namespace isorast {

namespace {

using gpu::Kind;
using Memory = gpu::Buffer::Memory;

constexpr uint32_t MAX_ROW = 65535;            // workgroups along x that every device can launch
constexpr uint32_t BLOCKS_AT_ONCE = 1u << 22;  // counted with one submission
constexpr uint64_t BATCH_BYTES = 64u << 20;    // of each of a batch's buffers, about
constexpr uint32_t ROW_VERTICES = 3 * 81;      // entries of 16 bits a block, see the shaders
constexpr uint32_t NO_SLOT = ~0u;

uint32_t row_of(uint64_t workgroups) {
    return uint32_t(std::min<uint64_t>(workgroups, MAX_ROW));
}

void dispatch_rows(gpu::Commands& commands, uint32_t workgroups) {
    const uint32_t row = row_of(workgroups);
    commands.dispatch(row, (workgroups + row - 1) / row);
}

gpu::Buffer host_buffer(const gpu::Device& device, uint64_t bytes) {
    return {device, std::max<uint64_t>(bytes, 16), Memory::host, "extracting the surface"};
}

template <class T>
void append(std::vector<T>& to, const gpu::Buffer& from, uint64_t count) {
    const size_t at = to.size();
    to.resize(at + count);
    std::memcpy(static_cast<void*>(to.data() + at), from.data<std::byte>(), count * sizeof(T));
}

// Adds up the counts of the blocks.
std::vector<Surface::Block> scan(const std::vector<uint32_t>& counts) {
    std::vector<Surface::Block> blocks;
    uint64_t vertices = 0, triangles = 0;
    for (uint32_t block = 0; block < counts.size(); ++block) {
        if (counts[block] == 0) continue;
        blocks.push_back({block, uint32_t(vertices), uint32_t(triangles)});
        vertices += counts[block] & 0xffff;
        triangles += counts[block] >> 16;
    }
    if (std::max(vertices, triangles) > UINT32_MAX)
        throw Error(fmt::format(
            "surface: expected at most {} vertices and triangles, found {} and {}; use a smaller "
            "volume or a smoother isovalue",
            UINT32_MAX, vertices, triangles));
    blocks.push_back({uint32_t(counts.size()), uint32_t(vertices), uint32_t(triangles)});
    return blocks;
}

}  // namespace

// Blocks to extract, and those above them that own edges which they share: places in
// Surface::blocks. `span`: how many blocks, listed or not, from the first to the last that may.
struct SurfaceExtractor::Batch {
    size_t first = 0, end = 0, shared_end = 0;
    uint64_t span = 0;
};

SurfaceExtractor::SurfaceExtractor(const Grid& grid, bool gradients)
    : grid_(grid), gradients_(gradients) {
    const gpu::Device& device = grid.device();
    const auto make = [&](const char* name, uint32_t buffers, uint32_t push_words,
                          std::span<const uint32_t> one, std::span<const uint32_t> several) {
        return gpu::Pipeline::compute(device,
                                      grid.pipeline_info(name, std::vector(buffers, Kind::buffer),
                                                         4 * push_words, {gradients}),
                                      grid.pick(one, several));
    };
    count_ = make("count surface", 2, 4, surface_count_comp, surface_count_comp_bricked);
    vertices_ =
        make("surface vertices", 5, 5, surface_vertices_comp, surface_vertices_comp_bricked);
    triangles_ =
        make("surface triangles", 5, 5, surface_triangles_comp, surface_triangles_comp_bricked);
    const CaseTable table = marching_cubes_table();
    cases_ = host_buffer(device, sizeof(table.packed));
    std::memcpy(cases_.data<std::byte>(), table.packed.data(), sizeof(table.packed));
}

Surface SurfaceExtractor::extract(float isovalue) const {
    Surface surface;
    surface.blocks = scan(count(isovalue));
    surface.positions.reserve(surface.blocks.back().first_vertex);
    surface.triangles.reserve(surface.blocks.back().first_triangle);
    if (gradients_) surface.gradients.reserve(surface.blocks.back().first_vertex);
    for (size_t first = 0; first + 1 < surface.blocks.size();) {
        const Batch batch = next_batch(surface, first);
        extract_batch(isovalue, batch, surface);
        first = batch.end;
    }
    return surface;
}

std::vector<uint32_t> SurfaceExtractor::count(float isovalue) const {
    struct Push {
        float isovalue;
        uint32_t first_block, block_count, workgroups_in_row;
    };
    std::vector<uint32_t> counts;
    const uint32_t blocks = grid_.info().blocks.w;
    const gpu::Buffer buffer =
        host_buffer(grid_.device(), sizeof(uint32_t) * std::min(blocks, BLOCKS_AT_ONCE));
    for (uint32_t first = 0; first < blocks; first += BLOCKS_AT_ONCE) {
        const uint32_t n = std::min(BLOCKS_AT_ONCE, blocks - first);
        gpu::run_once(grid_.device(), [&](gpu::Commands& commands) {
            grid_.begin_alone(commands);
            commands.bind(count_, {cases_, buffer});
            commands.push(Push{isovalue, first, n, row_of(n)});
            dispatch_rows(commands, n);
        });
        append(counts, buffer, n);
    }
    return counts;
}

SurfaceExtractor::Batch SurfaceExtractor::next_batch(const Surface& surface, size_t first) const {
    const auto& blocks = surface.blocks;
    const glm::uvec4 along = grid_.info().blocks;
    // The farthest block that owns edges of block b is b + reach.
    const uint64_t reach = 1 + along.x + uint64_t{along.x} * along.y;
    const auto bytes = [&](const Batch& batch) {
        const uint64_t vertices = blocks[batch.end].first_vertex - blocks[first].first_vertex;
        const uint64_t triangles = blocks[batch.end].first_triangle - blocks[first].first_triangle;
        return std::max({(gradients_ ? sizeof(glm::vec4) : sizeof(glm::vec3)) * vertices,
                         sizeof(glm::uvec3) * triangles, sizeof(uint32_t) * batch.span,
                         sizeof(uint16_t) * ROW_VERTICES * (batch.shared_end - first)});
    };
    const size_t last = blocks.size() - 1;
    Batch batch{first, first, first, 0};
    for (size_t end = first + 1; end <= last; ++end) {
        const uint64_t farthest = std::min<uint64_t>(blocks[end - 1].block + reach, along.w - 1);
        size_t shared_end = std::max(batch.shared_end, end);
        while (shared_end < last && blocks[shared_end].block <= farthest)
            ++shared_end;
        const Batch longer{first, end, shared_end, farthest - blocks[first].block + 1};
        if (end > first + 1 && bytes(longer) > BATCH_BYTES) break;
        batch = longer;
    }
    const uint64_t needed = bytes(batch);
    const uint64_t most = grid_.device().limits().maxStorageBufferRange;
    if (needed > most)
        throw Error(
            fmt::format("surface: needs a storage buffer of {} bytes, {} allows {}; use a smaller "
                        "volume or another device",
                        needed, grid_.device().info().name, most));
    return batch;
}

void SurfaceExtractor::extract_batch(float isovalue, const Batch& batch, Surface& surface) const {
    struct Push {
        float isovalue;
        uint32_t block_count, workgroups_in_row, a, b;
    };
    const gpu::Device& device = grid_.device();
    const auto all = uint32_t(batch.shared_end - batch.first);
    const auto own = uint32_t(batch.end - batch.first);
    const Surface::Block &first = surface.blocks[batch.first], &end = surface.blocks[batch.end];
    const uint32_t vertices = end.first_vertex - first.first_vertex;
    const uint32_t triangles = end.first_triangle - first.first_triangle;

    const gpu::Buffer listed = host_buffer(device, sizeof(glm::uvec4) * all);
    const gpu::Buffer slots = host_buffer(device, sizeof(uint32_t) * batch.span);
    std::fill_n(slots.data<uint32_t>(), batch.span, NO_SLOT);
    for (uint32_t slot = 0; slot < all; ++slot) {
        const Surface::Block& block = surface.blocks[batch.first + slot];
        listed.data<glm::uvec4>()[slot] = {block.block, block.first_vertex, block.first_triangle,
                                           0};
        slots.data<uint32_t>()[block.block - first.block] = slot;
    }
    const gpu::Buffer row_vertices(device, (sizeof(uint16_t) * ROW_VERTICES * all + 3) & ~3ull,
                                   Memory::device, "extracting the surface");
    const gpu::Buffer positions = host_buffer(device, sizeof(glm::vec3) * vertices);
    const gpu::Buffer gradients =
        host_buffer(device, gradients_ ? sizeof(glm::vec4) * vertices : 0);
    const gpu::Buffer indices = host_buffer(device, sizeof(glm::uvec3) * triangles);
    gpu::run_once(device, [&](gpu::Commands& commands) {
        grid_.begin_alone(commands);
        commands.bind(vertices_, {cases_, listed, row_vertices, positions, gradients});
        commands.push(Push{isovalue, all, row_of(all), own, first.first_vertex});
        dispatch_rows(commands, all);
        commands.barrier();
        commands.bind(triangles_, {cases_, listed, row_vertices, slots, indices});
        commands.push(Push{isovalue, own, row_of(own), first.block, first.first_triangle});
        dispatch_rows(commands, own);
    });
    append(surface.positions, positions, vertices);
    append(surface.triangles, indices, triangles);
    if (gradients_) append(surface.gradients, gradients, vertices);
}

}  // namespace isorast
