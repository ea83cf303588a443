// SPDX-License-Identifier: MIT
// Mesh files, read back byte by byte: what the formats' own documents ask for.
#include <gtest/gtest.h>
#include <isorast/error.h>
#include <isorast/mesh.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace {

using namespace isorast;
namespace fs = std::filesystem;

// A tetrahedron of side 1 at `origin`, wound outward.
Mesh tetrahedron(double origin = 0, double side = 1) {
    Mesh mesh;
    mesh.positions = {{origin, 0, 0}, {origin + side, 0, 0}, {origin, side, 0}, {origin, 0, side}};
    mesh.normals = {{-0.6f, -0.64f, -0.48f}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    mesh.name = "iso 300";
    mesh.length_units = "mm";
    return mesh;
}

class MeshFiles : public testing::Test {
protected:
    MeshFiles()
        : folder_(fs::temp_directory_path() / ("isorast_mesh_" + std::to_string(getpid()))) {
        fs::create_directories(folder_);
    }
    ~MeshFiles() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string written(const std::string& name, const std::vector<Mesh>& meshes) const {
        write_meshes(path(name), meshes);
        std::stringstream text;
        text << std::ifstream(path(name), std::ios::binary).rdbuf();
        return text.str();
    }
    std::string error_of(const std::string& name, const std::vector<Mesh>& meshes) const {
        try {
            write_meshes(path(name), meshes);
        } catch (const Error& error) {
            EXPECT_TRUE(fs::is_empty(folder_)) << "something is left of " << name;
            return error.what();
        }
        return "no error";
    }

private:
    fs::path folder_;
};

template <class T>
T value_at(const std::string& bytes, size_t at) {
    T value{};
    EXPECT_LE(at + sizeof(T), bytes.size());
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

TEST_F(MeshFiles, Stl) {
    const std::string bytes = written("a.STL", {tetrahedron()});
    ASSERT_EQ(bytes.size(), 84u + 4 * 50);
    EXPECT_STREQ(bytes.c_str(), "isorast, iso 300, lengths in mm");
    EXPECT_EQ(value_at<uint32_t>(bytes, 80), 4u);
    // The last triangle: its normal, then its second corner.
    const size_t last = 84 + 3 * 50;
    for (size_t axis = 0; axis < 3; ++axis)
        EXPECT_FLOAT_EQ(value_at<float>(bytes, last + 4 * axis), 1 / std::sqrt(3.0f));
    EXPECT_EQ(value_at<float>(bytes, last + 24 + 4), 1.0f);
    EXPECT_EQ(value_at<uint16_t>(bytes, last + 48), 0);
}

TEST_F(MeshFiles, Ply) {
    const std::string bytes = written("a.ply", {tetrahedron()});
    const std::string header =
        "ply\nformat binary_little_endian 1.0\ncomment isorast, iso 300, lengths in mm\n"
        "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
    ASSERT_TRUE(bytes.starts_with(header));
    ASSERT_EQ(bytes.size(), header.size() + 4 * 24 + 4 * 13);
    EXPECT_EQ(value_at<float>(bytes, header.size() + 24), 1.0f);   // x of the second vertex
    EXPECT_EQ(value_at<float>(bytes, header.size() + 12), -0.6f);  // nx of the first
    const size_t face = header.size() + 4 * 24 + 13;
    EXPECT_EQ(bytes[face], 3);
    EXPECT_EQ(value_at<int32_t>(bytes, face + 9), 3);
}

TEST_F(MeshFiles, Obj) {
    Mesh second = tetrahedron(5);
    second.name = "iso 0.5";
    const std::string text = written("a.obj", {tetrahedron(), second});
    for (const char* line :
         {"# isorast, iso 300, lengths in mm\no iso_300\n", "o iso_0.5\n", "v 1 0 0\n", "v 6 0 0\n",
          "vn -0.6 -0.64 -0.48\n", "f 1//1 3//3 2//2\n", "f 6//6 7//7 8//8\n"})
        EXPECT_NE(text.find(line), std::string::npos) << line;
    EXPECT_EQ(std::ranges::count(text, '\n'), 2 * (2 + 4 + 4 + 4));
}

TEST_F(MeshFiles, Glb) {
    Mesh second = tetrahedron(5);
    second.name = "iso 0.5";
    const std::string bytes = written("a.glb", {tetrahedron(), second});
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(value_at<uint32_t>(bytes, 4), 2u);
    EXPECT_EQ(value_at<uint32_t>(bytes, 8), bytes.size());
    const auto json_size = value_at<uint32_t>(bytes, 12);
    EXPECT_EQ(json_size % 4, 0u);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    const auto json = nlohmann::json::parse(bytes.substr(20, json_size));
    const size_t binary = 20 + json_size + 8;
    EXPECT_EQ(bytes.substr(binary - 4, 4), std::string("BIN\0", 4));
    EXPECT_EQ(value_at<uint32_t>(bytes, binary - 8), bytes.size() - binary);
    EXPECT_EQ(json["buffers"][0]["byteLength"], bytes.size() - binary);
    EXPECT_EQ(json["nodes"][0]["scale"], nlohmann::json({0.001, 0.001, 0.001}));
    EXPECT_EQ(json["nodes"][0]["children"], nlohmann::json({1, 2}));
    EXPECT_EQ(json["nodes"][2]["name"], "iso 0.5");
    EXPECT_EQ(json["nodes"][2]["translation"], nlohmann::json({5.5, 0.5, 0.5}));

    // The second mesh's first triangle, through node, accessor and view.
    const auto& primitive = json["meshes"][json["nodes"][2]["mesh"].get<int>()]["primitives"][0];
    const auto start = [&](const nlohmann::json& number) {
        const auto& accessor = json["accessors"][number.get<int>()];
        return binary +
               json["bufferViews"][accessor["bufferView"].get<int>()]["byteOffset"].get<size_t>();
    };
    EXPECT_EQ(value_at<uint32_t>(bytes, start(primitive["indices"]) + 4), 2u);
    EXPECT_EQ(value_at<float>(bytes, start(primitive["attributes"]["POSITION"])), -0.5f);
    EXPECT_EQ(value_at<float>(bytes, start(primitive["attributes"]["NORMAL"])), -0.6f);
    const auto& position = json["accessors"][primitive["attributes"]["POSITION"].get<int>()];
    EXPECT_EQ(position["min"], nlohmann::json({-0.5, -0.5, -0.5}));
    EXPECT_EQ(position["max"], nlohmann::json({0.5, 0.5, 0.5}));
}

nlohmann::json json_of(const std::string& glb) {
    return nlohmann::json::parse(glb.substr(20, value_at<uint32_t>(glb, 12)));
}

TEST_F(MeshFiles, GlbOfAnyText) {
    Mesh mesh = tetrahedron();
    for (const std::string text :
         {"\\mu m", "\"", "a\nb\x01", "\u00b5 \U0001f9e0", "\xf4\x8f\xbf\xbf"}) {
        mesh.name = mesh.length_units = text;
        const auto json = json_of(written("a.glb", {mesh}));
        EXPECT_EQ(json["nodes"][0]["extras"]["lengths"], text);
        EXPECT_EQ(json["nodes"][1]["name"], text);
        EXPECT_EQ(json["meshes"][0]["name"], text);
    }
    // What is no UTF-8 is taken for Latin-1: stray bytes, detours, surrogates, too large, cut off.
    for (const auto& [text, read] : {std::pair<std::string, std::string>{"\xb5m", "\u00b5m"},
                                     {"\xc1\xa1", "\u00c1\u00a1"},
                                     {"\xe0\xa0", "\u00e0\u00a0"},
                                     {"\xed\xa0\xa0", "\u00ed\u00a0\u00a0"},
                                     {"\xf4\xb0\xa0\xa0", "\u00f4\u00b0\u00a0\u00a0"},
                                     {"\xf0\xa0\xa0", "\u00f0\u00a0\u00a0"},
                                     {"\xc2 ", "\u00c2 "}}) {
        mesh.name = mesh.length_units = text;
        const auto json = json_of(written("a.glb", {mesh}));
        EXPECT_EQ(json["nodes"][0]["extras"]["lengths"], read);
        EXPECT_EQ(json["meshes"][0]["name"], read);
    }
}

TEST_F(MeshFiles, CoordinatesThatFloatsCannotTellApart) {
    // Far from the origin, vertices a hundredth apart.
    const Mesh far = tetrahedron(5e6, 0.01);
    EXPECT_NE(error_of("a.stl", {far}).find("write .obj"), std::string::npos);
    EXPECT_NE(error_of("a.ply", {far}).find("write .obj"), std::string::npos);
    EXPECT_NE(written("a.obj", {far}).find("v 5000000.01 0 0\n"), std::string::npos);
    written("a.glb", {far});  // its positions are relative
}

TEST_F(MeshFiles, Errors) {
    const std::vector<Mesh> two{tetrahedron(), tetrahedron(5)};
    EXPECT_NE(error_of("a.stl", two).find("STL holds one surface, found 2"), std::string::npos);
    EXPECT_NE(error_of("a.ply", two).find("write .obj or .glb"), std::string::npos);
    EXPECT_NE(error_of("a.step", two).find(".stl, .ply, .obj or .glb"), std::string::npos);
    EXPECT_NE(error_of("none/a.obj", two).find("none/a.obj: cannot be written"), std::string::npos);
    EXPECT_NE(error_of("a.glb", {Mesh{}}).find("no triangles"), std::string::npos);
}

TEST_F(MeshFiles, AFileThatIsThereIsReplacedOrKept) {
    written("a.obj", {tetrahedron(1)});
    const std::string before = written("a.obj", {tetrahedron(2)});
    EXPECT_NE(before.find("v 3 0 0\n"), std::string::npos);
    EXPECT_THROW(write_mesh(path("a.obj") + "/b.obj", tetrahedron()), Error);
}

}  // namespace
