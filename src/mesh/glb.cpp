// SPDX-License-Identifier: MIT
// glTF 2.0 in one binary file: a chunk of JSON that says what the bytes of the second chunk are.
// Each mesh has its positions relative to the middle of its box, so that 32-bit floats suffice
// anywhere; its node moves it there. The root node turns the world into what glTF wants: metres, y
// up.
#include <fmt/format.h>
#include <isorast/error.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "mesh/formats.h"
#include "volume/utf8.h"

namespace isorast {

static_assert(std::endian::native == std::endian::little);

namespace {

using Vector = std::array<float, 3>;

constexpr uint32_t ARRAY_BUFFER = 34962, ELEMENT_ARRAY_BUFFER = 34963;
constexpr uint32_t FLOAT = 5126, UNSIGNED_INT = 5125;

struct Box {
    std::array<double, 3> low{}, high{}, middle{};
};

Box box_of(const Mesh& mesh) {
    if (mesh.positions.empty()) return {};
    Box box{mesh.positions.front(), mesh.positions.front(), {}};
    for (const auto& p : mesh.positions)
        for (size_t axis = 0; axis < 3; ++axis) {
            box.low[axis] = std::min(box.low[axis], p[axis]);
            box.high[axis] = std::max(box.high[axis], p[axis]);
        }
    for (size_t axis = 0; axis < 3; ++axis)
        box.middle[axis] = (box.low[axis] + box.high[axis]) / 2;
    return box;
}

double metres(const std::string& unit) {
    constexpr std::pair<std::string_view, double> UNITS[] = {
        {"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}, {"nm", 1e-9}};
    for (const auto& [name, length] : UNITS)
        if (unit == name) return length;
    return 1;
}

// A JSON string, quotes included.
std::string json_string(const std::string& text) {
    std::string json = "\"";
    for (const char c : as_utf8(text)) {
        if (c >= 0 && c < ' ') {
            json += fmt::format("\\u{:04x}", static_cast<int>(c));
        } else {
            if (c == '"' || c == '\\') json += '\\';
            json += c;
        }
    }
    return json + '"';
}

std::string vector_text(const auto& v) {
    return fmt::format("[{},{},{}]", v[0], v[1], v[2]);
}

// The JSON chunk: nodes, meshes, and where each array lies in the second chunk.
class Description {
public:
    void add(const Mesh& mesh) {
        const Box box = box_of(mesh);
        const size_t number = count_++, accessor = 3 * number;
        add_view(mesh.positions.size() * sizeof(Vector), ARRAY_BUFFER, FLOAT, mesh.positions.size(),
                 "VEC3",
                 fmt::format(R"(,"min":{},"max":{})", vector_text(as_floats(box.low, box.middle)),
                             vector_text(as_floats(box.high, box.middle))));
        add_view(mesh.normals.size() * sizeof(Vector), ARRAY_BUFFER, FLOAT, mesh.normals.size(),
                 "VEC3", "");
        add_view(mesh.triangles.size() * 3 * sizeof(uint32_t), ELEMENT_ARRAY_BUFFER, UNSIGNED_INT,
                 3 * mesh.triangles.size(), "SCALAR", "");
        children_ += fmt::format("{}{}", number ? "," : "", number + 1);
        nodes_ += fmt::format(R"(,{{"name":{},"mesh":{},"translation":{}}})",
                              json_string(mesh.name), number, vector_text(box.middle));
        meshes_ += fmt::format(
            R"({}{{"name":{},"primitives":[{{"attributes":{{"POSITION":{},"NORMAL":{}}},)"
            R"("indices":{},"material":0}}]}})",
            number ? "," : "", json_string(mesh.name), accessor, accessor + 1, accessor + 2);
    }

    std::string text(const std::string& unit) const {
        const double scale = metres(unit);
        return fmt::format(
            R"({{"asset":{{"version":"2.0","generator":"isorast"}},"scene":0,)"
            R"("scenes":[{{"nodes":[0]}}],"nodes":[{{"name":"world","children":[{}],)"
            R"("rotation":[-0.7071067811865476,0,0,0.7071067811865476],"scale":[{},{},{}],)"
            R"("extras":{{"lengths":{}}}}}{}],"meshes":[{}],"materials":[{{"doubleSided":true,)"
            R"("pbrMetallicRoughness":{{"baseColorFactor":[0.77,0.6,0.39,1],"metallicFactor":0,)"
            R"("roughnessFactor":0.6}}}}],"accessors":[{}],"bufferViews":[{}],)"
            R"("buffers":[{{"byteLength":{}}}]}})",
            children_, scale, scale, scale, json_string(unit.empty() ? "unknown" : unit), nodes_,
            meshes_, accessors_, views_, bytes_);
    }
    uint64_t bytes() const { return bytes_; }  // of the second chunk

private:
    void add_view(uint64_t bytes, uint32_t target, uint32_t type, size_t count, const char* shape,
                  const std::string& range) {
        const char* comma = views_.empty() ? "" : ",";
        accessors_ +=
            fmt::format(R"({}{{"bufferView":{},"componentType":{},"count":{},"type":"{}"{}}})",
                        comma, view_count_++, type, count, shape, range);
        views_ += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{},"target":{}}})",
                              comma, bytes_, bytes, target);
        bytes_ += bytes;
    }

    size_t count_ = 0, view_count_ = 0;
    uint64_t bytes_ = 0;
    std::string children_, nodes_, meshes_, accessors_, views_;
};

void write_chunk_header(WholeFile& file, uint64_t bytes, const char* type) {
    const auto length = uint32_t(bytes);
    file.write(&length, sizeof(length));
    file.write(type, 4);
}

}  // namespace

void write_glb(const std::string& path, const std::vector<Mesh>& meshes) {
    Description description;
    for (const Mesh& mesh : meshes) {
        require_floats(path, mesh, box_of(mesh).middle);
        // A mesh of nothing is no valid glTF.
        if (mesh.triangles.empty())
            throw Error(fmt::format("{}: {} has no triangles", path, mesh.name));
        description.add(mesh);
    }
    std::string json = description.text(meshes.empty() ? "" : meshes.front().length_units);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const uint64_t total = 12 + 8 + json.size() + 8 + description.bytes();
    if (total > std::numeric_limits<uint32_t>::max())
        throw Error(fmt::format("{}: glTF's binary form ends at 4 GiB, found {} bytes; write .ply",
                                path, total));
    WholeFile file(path);
    const std::array<uint32_t, 2> version_and_length{2, uint32_t(total)};
    file.write("glTF", 4);
    file.write(version_and_length.data(), sizeof(version_and_length));
    write_chunk_header(file, json.size(), "JSON");
    file.write(json);
    write_chunk_header(file, description.bytes(), "BIN\0");
    for (const Mesh& mesh : meshes) {
        const auto middle = box_of(mesh).middle;
        for (const auto& p : mesh.positions) {
            const Vector f = as_floats(p, middle);
            file.write(f.data(), sizeof(f));
        }
        file.write(mesh.normals);
        file.write(mesh.triangles);
    }
    file.finish();
}

}  // namespace isorast
