// SPDX-License-Identifier: MIT
// Marching cubes as block_lists.glsl reads it.
#include <array>
#include <cstdint>

#include "gpu/device.h"
#include "shaders/marching_cubes.h"
#include "techniques/direct/rasterizer.h"

namespace isorast {

namespace {

using gpu::Commands;

// Where an edge of a cell (cell_rows.glsl) is, counted from the cell: rows on << 5, and bits on.
uint32_t place_of_edge(uint32_t edge) {
    const uint32_t axis = edge >> 2, low = edge & 1, high = edge >> 1 & 1;
    const uint32_t rows = axis == 0 ? low + 9 * high : axis == 1 ? 9 * high : high;
    const uint32_t bits = axis == 0 ? 0 : axis == 1 ? 8 + low : 17 + low;
    return rows << 5 | bits;
}

}  // namespace

gpu::Buffer upload_triangle_table(const gpu::Device& device) {
    constexpr uint32_t MOST = 5;  // triangles in a cell
    const CaseTable cases = marching_cubes_table();
    std::array<uint32_t, 256 * MOST> table{};
    for (uint32_t cell_case = 0; cell_case < 256; ++cell_case) {
        const uint32_t count = cases.triangle_count(cell_case);
        for (uint32_t corner = 0; corner < 3 * count; ++corner)
            table[MOST * cell_case + corner / 3] |= place_of_edge(cases.edge(cell_case, corner))
                                                    << 9 * (corner % 3);
        table[MOST * cell_case] |= count << 29;
    }
    gpu::Buffer buffer(device, sizeof(table), gpu::Buffer::Memory::device, "marching cubes");
    gpu::run_once(device, [&](Commands& commands) {
        commands.update(buffer, 0, table.data(), sizeof(table));
    });
    return buffer;
}

}  // namespace isorast
