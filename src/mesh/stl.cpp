// SPDX-License-Identifier: MIT
// Binary STL: 80 bytes of text, the number of triangles, and 50 bytes a triangle: its normal and
// corners as floats, and 2 bytes that mean nothing.
#include <fmt/format.h>
#include <isorast/error.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "mesh/formats.h"

namespace isorast {

static_assert(std::endian::native == std::endian::little);

namespace {

using Vector = std::array<float, 3>;

// Of the corners as they are written.
Vector normal_of(const std::array<Vector, 3>& corners) {
    const auto edge = [&](int corner, int axis) {
        return double(corners[corner][axis]) - corners[0][axis];
    };
    std::array<double, 3> n{};
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        n[i] = edge(1, j) * edge(2, k) - edge(1, k) * edge(2, j);
    }
    const double length = std::hypot(n[0], n[1], n[2]);
    if (length == 0) return {0, 0, 0};  // readers then compute it themselves
    return {float(n[0] / length), float(n[1] / length), float(n[2] / length)};
}

}  // namespace

void write_stl(const std::string& path, const Mesh& mesh) {
    if (mesh.triangles.size() > UINT32_MAX)
        throw Error(fmt::format("{}: STL holds {} triangles, found {}", path, UINT32_MAX,
                                mesh.triangles.size()));
    require_floats(path, mesh);
    WholeFile file(path);
    std::string header = describe(mesh);
    header.resize(80);
    const auto count = uint32_t(mesh.triangles.size());
    header.append(reinterpret_cast<const char*>(&count), sizeof(count));
    file.write(header);
    for (const auto& triangle : mesh.triangles) {
        std::array<Vector, 3> corners;
        for (size_t i = 0; i < 3; ++i)
            corners[i] = as_floats(mesh.positions[triangle[i]]);
        const Vector normal = normal_of(corners);
        std::array<char, 50> record{};
        std::memcpy(record.data(), normal.data(), sizeof(normal));
        std::memcpy(record.data() + sizeof(normal), corners.data(), sizeof(corners));
        file.write(record.data(), record.size());
    }
    file.finish();
}

}  // namespace isorast
