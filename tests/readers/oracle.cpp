// SPDX-License-Identifier: MIT
// Other libraries' readings of the same files, to compare ours with.
#include "oracle.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <isorast/load.h>

#include <cstdio>
#include <cstring>
#include <memory>
#include <sstream>

namespace isorast::test {
namespace {

// What a command prints, or nothing when it fails.
std::optional<std::string> output_of(const std::string& command) {
    FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return std::nullopt;
    std::string text;
    char piece[4096];
    while (const size_t got = fread(piece, 1, sizeof(piece), pipe))
        text.append(piece, got);
    if (pclose(pipe) != 0) return std::nullopt;
    return text;
}

// 64-bit FNV-1a over 8-byte words, the last one padded with zeros.
class Hash {
public:
    void add(std::span<const std::byte> bytes) {
        for (const std::byte byte : bytes) {
            word_ |= static_cast<uint64_t>(byte) << (8 * (count_ % 8));
            if (++count_ % 8 == 0) end_word();
        }
    }
    std::string text() {
        if (count_ % 8 != 0) end_word();
        return fmt::format("{:016x}", hash_);
    }

private:
    void end_word() {
        hash_ = (hash_ ^ word_) * 1099511628211ull;
        word_ = 0;
    }
    uint64_t hash_ = 14695981039346656037ull, word_ = 0, count_ = 0;
};

std::string hash_of(const Volume& volume, const std::string& path) {
    Hash hash;
    hash.add(volume.bytes.span());
    for (uint32_t step = 1; step < volume.time_steps; ++step) {
        LoadOptions options;
        options.time_step = step;
        hash.add(load_volume(path, options).bytes.span());
    }
    return hash.text();
}

VoxelType type_of(std::string word) {
    for (char& c : word)
        if (c == '_') c = ' ';
    if (word == "long") return VoxelType::i32;
    return parse_voxel_type(word).value();
}

std::string quoted_for_shell(const std::string& path) {
    return "'" + path + "'";
}

}  // namespace

void expect_same_voxels(const Volume& volume, const std::string& path, const Dump& dump) {
    std::vector<uint32_t> dims(volume.dims.begin(), volume.dims.end());
    dims.push_back(volume.time_steps);
    std::vector<uint32_t> expected;
    for (const std::string& word : dump.at("dims"))
        expected.push_back(static_cast<uint32_t>(std::stoul(word)));
    expected.resize(4, 1);
    EXPECT_EQ(dims, expected) << path;
    EXPECT_EQ(volume.type, type_of(dump.at("type")[0])) << path;
    EXPECT_EQ(hash_of(volume, path), dump.at("hash")[0]) << path << ": voxels differ";
}

bool has_itk() {
#ifdef ISORAST_ITK_DUMP
    return true;
#else
    return false;
#endif
}

namespace {

Dump parse_dump(std::istream& lines, std::string& next_file) {
    Dump dump;
    std::string line, name, word;
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        words >> name;
        if (name == "file") {
            std::getline(words >> std::ws, next_file);
            break;
        }
        dump[name];
        while (words >> word)
            dump[name].push_back(word);
    }
    return dump;
}

}  // namespace

std::optional<Dump> itk_dump([[maybe_unused]] const std::string& path) {
#ifdef ISORAST_ITK_DUMP
    const auto text = output_of(quoted_for_shell(ISORAST_ITK_DUMP) + " " + quoted_for_shell(path) +
                                " 2>/dev/null");
    if (!text) return std::nullopt;
    std::istringstream lines(*text);
    std::string none;
    return parse_dump(lines, none);
#else
    return std::nullopt;
#endif
}

void expect_like_itk(const std::string& path) {
    if (!has_itk()) return;
    const auto dump = itk_dump(path);
    ASSERT_TRUE(dump.has_value()) << "ITK cannot read " << path;
    const Volume volume = load_volume(path);
    ASSERT_EQ(dump->at("components")[0], "1");
    expect_same_voxels(volume, path, *dump);
    const auto& affine = dump->at("affine");
    if (affine.size() != 12) return;  // ITK knows no third axis of a picture
    for (size_t entry = 0; entry < 12; ++entry) {
        // Ours is RAS where the file says what the world is; ITK calls every world LPS.
        const bool flipped = volume.space == Space::ras && entry < 8;
        const double expected = std::stod(affine[entry]) * (flipped ? -1 : 1);
        EXPECT_NEAR(volume.affine.m[entry / 4][entry % 4], expected,
                    1e-5 * std::max(1.0, std::abs(expected)))
            << path << ": affine entry " << entry;
    }
}

std::map<std::string, Dump> nibabel_dumps(const std::vector<std::string>& paths) {
    const char* given = std::getenv("ISORAST_PYTHON");
    std::string command = given != nullptr ? given : "/usr/bin/python3";
    if (!output_of(command + " -c 'import nibabel' 2>/dev/null")) return {};
    command += " " + quoted_for_shell(ISORAST_SOURCE_DIR "/tests/oracles/nibabel_dump.py");
    for (const std::string& path : paths)
        command += " " + quoted_for_shell(path);
    const auto text = output_of(command);
    if (!text) {
        ADD_FAILURE() << "fails: " << command;
        return {};
    }
    std::istringstream lines(*text);
    std::map<std::string, Dump> dumps;
    std::string file, next;
    parse_dump(lines, next);
    while (lines) {
        file = std::exchange(next, "");
        dumps[file] = parse_dump(lines, next);
        if (next.empty()) break;
    }
    return dumps;
}

void expect_like_nibabel(const std::string& path, const Dump& dump) {
    const Volume volume = load_volume(path);
    expect_same_voxels(volume, path, dump);
    EXPECT_EQ(volume.slope, std::stod(dump.at("slope")[0])) << path;
    EXPECT_EQ(volume.intercept, std::stod(dump.at("slope")[1])) << path;
    if (dump.at("codes")[0] == "0" && dump.at("codes")[1] == "0") return;
    EXPECT_EQ(volume.space, Space::ras) << path;
    for (size_t entry = 0; entry < 12; ++entry) {
        const double expected = std::stod(dump.at("affine")[entry]);
        EXPECT_NEAR(volume.affine.m[entry / 4][entry % 4], expected,
                    1e-5 * std::max(1.0, std::abs(expected)))
            << path << ": affine entry " << entry;
    }
}

}  // namespace isorast::test
