// SPDX-License-Identifier: MIT
// Binary PLY (Turk 1994): positions and normals as floats, triangles as three vertex numbers.
#include <fmt/format.h>
#include <isorast/error.h>

#include <bit>
#include <cstring>
#include <limits>

#include "mesh/formats.h"

namespace isorast {

static_assert(std::endian::native == std::endian::little);

void write_ply(const std::string& path, const Mesh& mesh) {
    if (mesh.positions.size() > size_t(std::numeric_limits<int32_t>::max()))
        throw Error(fmt::format("{}: PLY numbers {} vertices, found {}; write .glb", path,
                                std::numeric_limits<int32_t>::max(), mesh.positions.size()));
    require_floats(path, mesh);
    WholeFile file(path);
    std::string header =
        fmt::format("ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n",
                    describe(mesh), mesh.positions.size());
    for (const char* property : {"x", "y", "z", "nx", "ny", "nz"})
        header += fmt::format("property float {}\n", property);
    file.write(header + fmt::format("element face {}\nproperty list uchar int vertex_indices\n"
                                    "end_header\n",
                                    mesh.triangles.size()));
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        const std::array both{as_floats(mesh.positions[i]), mesh.normals[i]};
        file.write(both.data(), sizeof(both));
    }
    for (const auto& triangle : mesh.triangles) {
        std::array<char, 13> record{3};
        std::memcpy(record.data() + 1, triangle.data(), sizeof(triangle));
        file.write(record.data(), record.size());
    }
    file.finish();
}

}  // namespace isorast
