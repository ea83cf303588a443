// SPDX-License-Identifier: MIT
// Pictures: comparison, and PNG files written, read, refused.
#include <gtest/gtest.h>
#include <isorast/error.h>
#include <isorast/image.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

namespace isorast {
namespace {

namespace fs = std::filesystem;

Image test_picture(uint32_t width, uint32_t height) {
    Image image{{width, height}, {}, {}};
    for (uint32_t at = 0; at < 4 * width * height; ++at) {
        image.rgba.push_back(static_cast<uint8_t>(at * 2654435761u >> 24));
    }
    return image;
}

std::string file_text(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string message_of(const auto& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

// A folder that goes away with the test.
struct PngFiles : testing::Test {
    fs::path folder;
    void SetUp() override {
        folder = fs::temp_directory_path() / ("isorast-image-test-" + std::to_string(getpid()));
        fs::create_directories(folder);
    }
    void TearDown() override { fs::remove_all(folder); }
    std::string path(const std::string& name) const { return (folder / name).string(); }
    void write(const std::string& name, const std::string& bytes) const {
        std::ofstream(path(name), std::ios::binary) << bytes;
    }
};

std::string big_endian(uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8)
        bytes += static_cast<char>(value >> shift);
    return bytes;
}

std::string chunk(const std::string& type, const std::string& data) {
    const std::string body = type + data;
    const auto sum = crc32(0, reinterpret_cast<const Bytef*>(body.data()), uInt(body.size()));
    return big_endian(uint32_t(data.size())) + body + big_endian(uint32_t(sum));
}

// A PNG made by hand; `rows` holds each row's filter byte and samples.
std::string png_of(uint32_t width, uint32_t height, char bits, char color, const std::string& rows,
                   const std::string& extra_chunks = "") {
    std::string packed(compressBound(rows.size()), '\0');
    uLongf size = packed.size();
    compress(reinterpret_cast<Bytef*>(packed.data()), &size,
             reinterpret_cast<const Bytef*>(rows.data()), rows.size());
    packed.resize(size);
    const std::string header =
        big_endian(width) + big_endian(height) + bits + color + std::string(3, '\0');
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + extra_chunks + chunk("IDAT", packed) +
           chunk("IEND", "");
}

using Pixel = std::array<uint8_t, 4>;

TEST(Image, PixelCountsRowsFromTheTop) {
    const Image image = test_picture(5, 3);
    EXPECT_EQ(image.pixel(0, 0)[0], image.rgba[0]);
    EXPECT_EQ(image.pixel(4, 2)[3], image.rgba.back());
    EXPECT_THROW(image.pixel(0, 3), std::out_of_range);
}

TEST(Image, CompareCountsPixelsAndChannels) {
    const Image a = test_picture(10, 10);
    EXPECT_EQ(compare(a, a).maximum, 0);
    EXPECT_EQ(compare(a, a).pixels_over, 0u);
    Image b = a;
    b.rgba[4] = a.rgba[4] < 128 ? a.rgba[4] + 30 : a.rgba[4] - 30;
    b.rgba[5] = a.rgba[5] < 128 ? a.rgba[5] + 40 : a.rgba[5] - 40;  // the same pixel
    b.rgba[399] = a.rgba[399] < 128 ? a.rgba[399] + 2 : a.rgba[399] - 2;
    const Difference all = compare(a, b);
    EXPECT_EQ(all.maximum, 40);
    EXPECT_EQ(all.pixels_over, 2u);
    EXPECT_DOUBLE_EQ(all.share_over, 0.02);
    EXPECT_DOUBLE_EQ(all.root_mean_square, std::sqrt((900 + 1600 + 4) / 400.0));
    EXPECT_EQ(compare(a, b, 2).pixels_over, 1u);
    EXPECT_EQ(compare(a, b, 40).pixels_over, 0u);
    EXPECT_EQ(compare(a, b, 39.5).pixels_over, 1u);
}

TEST(Image, CompareRefusesOtherSizes) {
    const std::string message =
        message_of([] { compare(test_picture(10, 10), test_picture(20, 5)); });
    EXPECT_NE(message.find("10x10 and 20x5"), std::string::npos) << message;
    Image broken = test_picture(10, 10);
    broken.rgba.pop_back();
    EXPECT_THROW(compare(broken, broken), Error);
    const Image image = test_picture(2, 2);
    EXPECT_THROW(compare(image, image, std::nan("")), Error);
}

TEST(Image, DifferenceShowsToleranceAsMidGrey) {
    Image a{{3, 1}, {10, 10, 10, 255, 10, 10, 10, 255, 10, 10, 10, 255}, {}};
    Image b{{3, 1}, {10, 14, 10, 255, 10, 10, 10, 251, 200, 10, 10, 255}, {}};
    const Image picture = difference_picture(a, b, 4);
    EXPECT_EQ(picture.pixel(0, 0), (Pixel{0, 128, 0, 255}));
    EXPECT_EQ(picture.pixel(1, 0), (Pixel{128, 128, 128, 255}));  // alpha alone shows too
    EXPECT_EQ(picture.pixel(2, 0), (Pixel{255, 0, 0, 255}));
}

TEST_F(PngFiles, RoundTripIsExactWithTextAndProfile) {
    const Image image = test_picture(37, 11);
    write_png(path("a.png"), image, {{"Software", "isorast"}, {"Comment", "iso 300"}});
    const Image back = read_png(path("a.png"));
    EXPECT_EQ(back.size, image.size);
    EXPECT_EQ(back.rgba, image.rgba);
    const std::string bytes = file_text(path("a.png"));
    EXPECT_NE(bytes.find("sRGB"), std::string::npos);
    EXPECT_NE(bytes.find(chunk("tEXt", std::string("Comment\0iso 300", 15))), std::string::npos);
    const auto encoded = encode_png(image, {{"Software", "isorast"}, {"Comment", "iso 300"}});
    EXPECT_EQ(bytes, std::string(encoded.begin(), encoded.end()));
}

// tEXt is Latin-1 by PNG's specification, iTXt is UTF-8.
TEST_F(PngFiles, TextBeyondAsciiIsInternational) {
    const auto bytes_for = [](const std::string& value) {
        const auto encoded = encode_png(test_picture(2, 2), {{"Source", value}});
        return std::string(encoded.begin(), encoded.end());
    };
    const std::string start("Source\0\0\0\0\0", 11), name = "Sch\u00e4del.nrrd";
    EXPECT_NE(bytes_for(name).find(chunk("iTXt", start + name)), std::string::npos);
    EXPECT_EQ(bytes_for(name).find("tEXt"), std::string::npos);
    // A name in Latin-1 is no UTF-8, and tEXt as it is.
    const std::string latin =
        "Sch\xe4"
        "del.nrrd";
    EXPECT_NE(bytes_for(latin).find(chunk("tEXt", start.substr(0, 7) + latin)), std::string::npos);
    EXPECT_EQ(bytes_for("skull.nrrd").find("iTXt"), std::string::npos);
    write_png(path("a.png"), test_picture(2, 2), {{"Source", name}});
    EXPECT_EQ(read_png(path("a.png")).rgba, test_picture(2, 2).rgba);
}

TEST_F(PngFiles, FileIsReplacedWholeOrNotAtAll) {
    write_png(path("a.png"), test_picture(4, 4));
    write_png(path("a.png"), test_picture(8, 8));
    EXPECT_EQ(read_png(path("a.png")).size, (Size{8, 8}));
    fs::create_directory(path("folder.png"));
    EXPECT_THROW(write_png(path("folder.png"), test_picture(4, 4)), Error);
    EXPECT_EQ(message_of([&] { write_png(path("no/a.png"), test_picture(4, 4)); }),
              path("no/a.png") + ": cannot be written: No such file or directory");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2);  // nothing temporary is left
    write_png("/dev/null", test_picture(4, 4));
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(PngFiles, EncodeRefusesWhatIsNoPicture) {
    EXPECT_THROW(encode_png(Image{{0, 4}, {}, {}}), Error);
    EXPECT_THROW(encode_png(Image{{4, 4}, std::vector<uint8_t>(63), {}}), Error);
    EXPECT_THROW(encode_png(test_picture(4, 4), {{"", "x"}}), Error);
}

TEST_F(PngFiles, ReadsEveryKind) {
    write("grey.png", png_of(2, 1, 8, 0, std::string("\0\x40\xff", 3)));
    EXPECT_EQ(read_png(path("grey.png")).pixel(0, 0), (Pixel{64, 64, 64, 255}));
    write("bits.png", png_of(2, 1, 1, 0, std::string("\0\x40", 2)));
    EXPECT_EQ(read_png(path("bits.png")).pixel(1, 0), (Pixel{255, 255, 255, 255}));
    write("rgb.png", png_of(1, 1, 8, 2, std::string("\0\x01\x02\x03", 4)));
    EXPECT_EQ(read_png(path("rgb.png")).pixel(0, 0), (Pixel{1, 2, 3, 255}));
    write("deep.png", png_of(1, 1, 16, 2, std::string("\0\x80\x80\x40\x40\xff\xff", 7)));
    EXPECT_EQ(read_png(path("deep.png")).pixel(0, 0), (Pixel{128, 64, 255, 255}));
    write("palette.png", png_of(2, 1, 8, 3, std::string("\0\0\1", 3),
                                chunk("PLTE", "abcdef") + chunk("tRNS", std::string("\x7f", 1))));
    EXPECT_EQ(read_png(path("palette.png")).pixel(0, 0), (Pixel{'a', 'b', 'c', 127}));
    EXPECT_EQ(read_png(path("palette.png")).pixel(1, 0), (Pixel{'d', 'e', 'f', 255}));
}

TEST_F(PngFiles, BrokenFilesGiveOneLine) {
    const std::string good = png_of(2, 2, 8, 0, std::string("\0\1\2\0\3\4", 6));
    for (size_t length = 0; length < good.size() - 12; ++length) {  // IEND may be missing
        write("cut.png", good.substr(0, length));
        const std::string message = message_of([&] { read_png(path("cut.png")); });
        EXPECT_EQ(message.find(path("cut.png") + ": "), 0u) << length << ' ' << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
    std::string flipped = good;
    flipped[20] ^= 1;  // the width, without its checksum
    write("flipped.png", flipped);
    EXPECT_THROW(read_png(path("flipped.png")), Error);
    write("huge.png", png_of(900000, 900000, 8, 6, "x"));
    EXPECT_NE(message_of([&] { read_png(path("huge.png")); }).find("claims 900000x900000"),
              std::string::npos);
    EXPECT_THROW(read_png(path("none.png")), Error);
    EXPECT_THROW(read_png(folder.string()), Error);
}

}  // namespace
}  // namespace isorast
