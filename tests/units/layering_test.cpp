// SPDX-License-Identifier: MIT
// The arrows of docs/architecture.md point one way: read off the #include lines and the calls under
// src/.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace {

namespace fs = std::filesystem;

struct Source {
    std::string path, text;             // the path below src/
    std::vector<std::string> includes;  // what stands between the quotes or brackets
};

Source read(std::string path, std::string text) {
    static const std::regex include(R"re((^|\n)[ \t]*#[ \t]*include[ \t]*[<"]([^>"]+)[>"])re");
    Source source{std::move(path), std::move(text), {}};
    for (std::sregex_iterator at(source.text.begin(), source.text.end(), include), end; at != end;
         ++at)
        source.includes.push_back((*at)[2]);
    return source;
}

std::vector<Source> sources() {
    const fs::path root = fs::path(ISORAST_SOURCE_DIR) / "src";
    std::vector<Source> result;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
        if (!entry.is_regular_file()) continue;
        std::stringstream text;
        text << std::ifstream(entry.path()).rdbuf();
        result.push_back(read(fs::relative(entry.path(), root).generic_string(), text.str()));
    }
    return result;
}

std::string first_part(const std::string& path) {
    return path.substr(0, path.find('/'));
}

// The folder of a technique, "techniques/NAME/", or nothing.
std::string technique_of(const std::string& path) {
    std::smatch match;
    return std::regex_search(path, match, std::regex("^techniques/[^/]+/")) ? match[0].str() : "";
}

bool in_the_core(const std::string& path) {
    return !path.starts_with("volume/formats/") && path != "image/png.cpp";
}

// What is wrong with one file; nothing when it keeps to the rules.
std::string broken_rule(const Source& source) {
    static const std::regex format_library(
        "^(png|zlib|nifti\\w*|nifti/.*|znzlib|tiff\\w*|hdf5|zstd|gdcm.*|pugixml\\w*)\\.(h|hpp)$");
    static const std::regex device_call("\\bvk(CreateInstance|CreateDevice|AllocateMemory)\\b");
    const std::string folder = first_part(source.path), technique = technique_of(source.path);
    for (const std::string& include : source.includes) {
        const std::string to = first_part(include), other = technique_of(include);
        const std::set<std::string> above_volume{"vulkan",     "gpu",   "grid",   "passes",
                                                 "techniques", "image", "shaders"};
        if (folder == "volume" && above_volume.contains(to)) return "volume includes " + include;
        if (folder == "gpu" && (to == "grid" || to == "techniques" || to == "volume"))
            return "gpu includes " + include;
        if (folder == "grid" && to == "techniques") return "grid includes " + include;
        if (!technique.empty() && !other.empty() && technique != other)
            return "a technique includes " + include;
        if (in_the_core(source.path) && std::regex_match(include, format_library))
            return "the core includes " + include;
    }
    if (folder != "gpu" && std::regex_search(source.text, device_call))
        return "a device or memory is made outside src/gpu";
    return "";
}

TEST(Layering, EveryArrowPointsOneWay) {
    std::vector<Source> all = sources();
    EXPECT_GT(all.size(), 20u);
    for (const Source& source : all)
        EXPECT_EQ(broken_rule(source), "") << source.path;
}

TEST(Layering, PlantedFaultsAreFound) {
    const std::vector<std::pair<std::string, std::string>> faults{
        {"volume/load.cpp", "#include <vulkan/vulkan.h>\n"},
        {"volume/load.cpp", "// text\n#include \"grid/grid.h\"\n"},
        {"volume/field.cpp", "#include <png.h>\n"},
        {"gpu/device.cpp", "#include \"grid/grid.h\"\n"},
        {"grid/grid.cpp", "  vkAllocateMemory(device, &info, nullptr, &memory);\n"},
        {"techniques/direct/direct.cpp", "#include \"techniques/raymarch/raymarch.h\"\n"},
        {"techniques/raymarch/march.comp", "#include \"techniques/direct/list.glsl\"\n"},
    };
    for (const auto& [path, text] : faults)
        EXPECT_NE(broken_rule(read(path, text)), "") << path;
    EXPECT_EQ(broken_rule(read("volume/formats/nrrd.cpp", "#include <zlib.h>\n")), "");
    EXPECT_EQ(broken_rule(read("techniques/direct/a.cpp", "#include \"techniques/technique.h\"\n")),
              "");
}

}  // namespace
