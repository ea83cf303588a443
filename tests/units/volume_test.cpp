// SPDX-License-Identifier: MIT
// Volume, its bytes, statistics against a plain loop, and isovalues from words.
#include <gtest/gtest.h>
#include <isorast/error.h>
#include <isorast/volume.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>

namespace isorast {
namespace {

template <class T>
Volume volume_of(VoxelType type, std::array<uint32_t, 3> dims, const std::vector<T>& values) {
    Volume volume;
    volume.name = "test";
    volume.dims = dims;
    volume.type = type;
    const auto bytes = std::as_bytes(std::span(values));
    volume.bytes = VoxelBytes::own({bytes.begin(), bytes.end()});
    return volume;
}

template <class T>
Volume row_of(VoxelType type, const std::vector<T>& values) {
    return volume_of(type, {static_cast<uint32_t>(values.size()), 1, 1}, values);
}

std::string error_of(auto&& work) {
    try {
        work();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(VoxelTypes, NamesAndSizes) {
    const std::pair<const char*, size_t> types[] = {{"u8", 1},  {"i8", 1},  {"u16", 2}, {"i16", 2},
                                                    {"u32", 4}, {"i32", 4}, {"f32", 4}, {"f64", 8}};
    for (const auto& [name, size] : types) {
        const auto type = parse_voxel_type(name);
        ASSERT_TRUE(type.has_value()) << name;
        EXPECT_EQ(name_of(*type), name);
        EXPECT_EQ(bytes_of(*type), size);
    }
    EXPECT_EQ(parse_voxel_type("UInt8"), VoxelType::u8);
    EXPECT_EQ(parse_voxel_type("unsigned short"), VoxelType::u16);
    EXPECT_EQ(parse_voxel_type("Float"), VoxelType::f32);
    for (const char* word : {"", "u7", "int64", "floaty", "u8 "})
        EXPECT_FALSE(parse_voxel_type(word)) << word;
}

TEST(AffineTest, AppliesAndMeasures) {
    const Affine affine{{{{0, -2, 0, 10}, {3, 0, 0, 20}, {4, 0, 6, 30}}}};
    EXPECT_EQ(affine(1, 2, 3), (std::array<double, 3>{6, 23, 52}));
    EXPECT_EQ(affine.spacing(), (std::array<double, 3>{5, 2, 6}));
    EXPECT_DOUBLE_EQ(affine.determinant(), 36);
    EXPECT_DOUBLE_EQ(Affine::scaling(2, 3, 4).determinant(), 24);
}

TEST(VoxelBytesTest, OwnsBorrowsAndMoves) {
    std::vector<std::byte> bytes{std::byte{1}, std::byte{2}, std::byte{3}};
    const VoxelBytes borrowed = VoxelBytes::borrow(bytes);
    EXPECT_EQ(borrowed.span().data(), bytes.data());
    EXPECT_FALSE(borrowed.mapped());

    VoxelBytes owned = VoxelBytes::own(bytes);
    const std::byte* where = owned.span().data();
    VoxelBytes moved(std::move(owned));
    EXPECT_EQ(moved.span().data(), where);
    EXPECT_EQ(moved.span().size(), 3u);
    EXPECT_TRUE(owned.span().empty());  // NOLINT(bugprone-use-after-move): empty by contract
    VoxelBytes assigned = VoxelBytes::own({std::byte{9}});
    assigned = std::move(moved);
    EXPECT_EQ(assigned.span()[2], std::byte{3});
    EXPECT_TRUE(moved.span().empty());  // NOLINT(bugprone-use-after-move)
    VoxelBytes& itself = assigned;
    assigned = std::move(itself);
    EXPECT_EQ(assigned.span().size(), 3u);
}

TEST(VoxelBytesTest, MapsAnyPartOfAFile) {
    const auto path = (std::filesystem::temp_directory_path() /
                       ("isorast-map-" + std::to_string(getpid()) + ".raw"))
                          .string();
    std::string content(10000, '\0');
    std::iota(content.begin(), content.end(), 0);
    std::ofstream(path, std::ios::binary) << content;
    const std::pair<uint64_t, uint64_t> windows[] = {{0, 10000},   {1, 9999}, {4096, 10},
                                                     {4099, 5000}, {9999, 1}, {10000, 0}};
    for (const auto& [offset, size] : windows) {
        VoxelBytes bytes = VoxelBytes::map(path, offset, size);
        const VoxelBytes moved(std::move(bytes));
        EXPECT_EQ(moved.mapped(), size > 0);
        ASSERT_EQ(moved.span().size(), size);
        const auto expected = std::as_bytes(std::span(content)).subspan(offset, size);
        EXPECT_TRUE(std::ranges::equal(moved.span(), expected));
    }
    EXPECT_THROW(VoxelBytes::map(path, 0, 10001), Error);
    EXPECT_THROW(VoxelBytes::map(path, 10001, 0), Error);
    EXPECT_THROW(VoxelBytes::map(path, UINT64_MAX, 2), Error);
    EXPECT_THROW(VoxelBytes::map(path, 2, UINT64_MAX), Error);
    std::filesystem::remove(path);
    EXPECT_THROW(VoxelBytes::map(path, 0, 1), Error);
    EXPECT_THROW(VoxelBytes::map("/", 0, 1), Error);
}

TEST(VolumeTest, ValueAppliesSlopeAndIntercept) {
    Volume volume = volume_of<int16_t>(VoxelType::i16, {2, 2, 2}, {0, 1, 2, 3, 4, 5, 6, -7});
    EXPECT_EQ(volume.value(1, 0, 1), 5);
    volume.slope = 0.5;
    volume.intercept = -1;
    EXPECT_EQ(volume.value(1, 1, 1), -4.5);
}

TEST(VolumeTest, CheckFindsWhatIsWrong) {
    const auto complaint = [](auto&& damage) {
        Volume volume = volume_of<uint8_t>(VoxelType::u8, {2, 2, 2}, std::vector<uint8_t>(8));
        damage(volume);
        const std::string message = error_of([&] { check(volume); });
        EXPECT_EQ(message.find('\n'), std::string::npos);
        return message;
    };
    EXPECT_EQ(complaint([](Volume&) {}), "");
    EXPECT_NE(complaint([](Volume& v) { v.dims[1] = 0; }).find("at least 1"), std::string::npos);
    EXPECT_NE(complaint([](Volume& v) { v.dims[1] = 3; }).find("expected 12 bytes"),
              std::string::npos);
    EXPECT_NE(complaint([](Volume& v) { v.dims = {UINT32_MAX, UINT32_MAX, 1}; }).find("63 bits"),
              std::string::npos);
    EXPECT_NE(
        complaint([](Volume& v) { v.dims = {UINT32_MAX, UINT32_MAX, UINT32_MAX}; }).find("63 bits"),
        std::string::npos);
    EXPECT_NE(complaint([](Volume& v) { v.dims = {0, UINT32_MAX, UINT32_MAX}; }).find("at least 1"),
              std::string::npos);
    EXPECT_NE(complaint([](Volume& v) { v.bytes = {}; }).find("found 0"), std::string::npos);
    EXPECT_EQ(complaint([](Volume& v) {
                  v.bytes = {};
                  v.field = Field{};
              }),
              "");
    EXPECT_NE(complaint([](Volume& v) { v.affine.m[2][2] = 0; }).find("affine"), std::string::npos);
    EXPECT_NE(complaint([](Volume& v) { v.affine.m[0][3] = NAN; }).find("affine"),
              std::string::npos);
    EXPECT_EQ(complaint([](Volume& v) { v.affine = Affine::scaling(1e-9, 1e-9, -1e-9); }), "");
    EXPECT_NE(complaint([](Volume& v) { v.slope = 0; }), "");
    EXPECT_NE(complaint([](Volume& v) { v.intercept = NAN; }), "");
}

// The same by a plain loop over Volume::value.
void expect_statistics(const Volume& volume) {
    const Statistics found = statistics(volume, 100);
    std::vector<double> values;
    uint64_t not_finite = 0;
    for (uint32_t i = 0; i < volume.dims[0]; ++i) {
        const double value = volume.value(i, 0, 0);
        if (std::isfinite(value))
            values.push_back(value);
        else
            ++not_finite;
    }
    EXPECT_EQ(found.finite, values.size());
    EXPECT_EQ(found.not_finite, not_finite);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    EXPECT_EQ(found.minimum, *low);
    EXPECT_EQ(found.maximum, *high);
    const auto count = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
    double squares = 0;
    for (const double value : values)
        squares += (value - mean) * (value - mean);
    const double scale = std::max(std::abs(*low), std::abs(*high));
    EXPECT_NEAR(found.mean, mean, 1e-9 * scale);
    EXPECT_NEAR(found.standard_deviation, std::sqrt(squares / count), 1e-9 * scale);

    ASSERT_EQ(found.histogram.size(), 100u);
    EXPECT_EQ(std::accumulate(found.histogram.begin(), found.histogram.end(), uint64_t{0}),
              values.size());
    std::sort(values.begin(), values.end());
    const double width = (*std::max_element(values.begin(), values.end()) - values.front()) / 100;
    for (const double percent : {0.0, 1.0, 25.0, 50.0, 99.0, 100.0}) {
        const double rank = percent / 100 * (count - 1);
        EXPECT_GE(found.percentile(percent),
                  values[static_cast<size_t>(rank)] - width - 1e-9 * scale);
        EXPECT_LE(found.percentile(percent),
                  values[static_cast<size_t>(std::ceil(rank))] + width + 1e-9 * scale);
    }
}

template <class T>
std::vector<T> noise(size_t count) {
    std::vector<T> values(count);
    uint64_t state = 1;
    for (T& value : values) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        if constexpr (std::is_floating_point_v<T>)
            value = static_cast<T>(static_cast<double>(state >> 40) / 1e3 - 5e3);
        else
            value = static_cast<T>(state >> 33);
    }
    return values;
}

template <class T>
void expect_statistics_of(VoxelType type) {
    for (const size_t count :
         {size_t{1}, size_t{1000}, size_t{(1 << 20) + 77}}) {  // in several chunks, too
        Volume volume = row_of(type, noise<T>(count));
        expect_statistics(volume);
        volume.slope = -0.25;
        volume.intercept = 100;
        expect_statistics(volume);
    }
}

TEST(StatisticsTest, LikeAPlainLoop) {
    expect_statistics_of<uint8_t>(VoxelType::u8);
    expect_statistics_of<int8_t>(VoxelType::i8);
    expect_statistics_of<uint16_t>(VoxelType::u16);
    expect_statistics_of<int16_t>(VoxelType::i16);
    expect_statistics_of<uint32_t>(VoxelType::u32);
    expect_statistics_of<int32_t>(VoxelType::i32);
    expect_statistics_of<float>(VoxelType::f32);
    expect_statistics_of<double>(VoxelType::f64);
}

TEST(StatisticsTest, NotFiniteVoxelsAreCountedApart) {
    constexpr float inf = std::numeric_limits<float>::infinity();
    expect_statistics(row_of<float>(VoxelType::f32, {1, NAN, 2, inf, -inf, 4}));
    const Statistics none = statistics(row_of<float>(VoxelType::f32, {NAN, inf}));
    EXPECT_EQ(none.finite, 0u);
    EXPECT_EQ(none.not_finite, 2u);
    EXPECT_EQ(none.percentile(50), 0);
    const Volume volume = row_of<float>(VoxelType::f32, {NAN, inf});
    EXPECT_EQ(suggest_isovalue(volume, none), 0);
}

TEST(StatisticsTest, ExtremeRanges) {
    constexpr double most = std::numeric_limits<double>::max();
    const Statistics all = statistics(row_of<double>(VoxelType::f64, {-most, 0, most}), 3);
    EXPECT_EQ(all.histogram, (std::vector<uint64_t>{1, 1, 1}));
    const Statistics constant = statistics(row_of<int32_t>(VoxelType::i32, {7, 7, 7}), 4);
    EXPECT_EQ(constant.histogram, (std::vector<uint64_t>{3, 0, 0, 0}));
    EXPECT_EQ(constant.percentile(99), 7);
    EXPECT_EQ(constant.standard_deviation, 0);
    // A large offset does not spoil the deviation.
    const Statistics offset =
        statistics(row_of<double>(VoxelType::f64, {1e9 + 1, 1e9 + 2, 1e9 + 3}));
    EXPECT_NEAR(offset.standard_deviation, std::sqrt(2.0 / 3), 1e-9);
}

template <class T>
Statistics with_fill(VoxelType type, T fill) {
    std::vector<T> values;
    for (int i = 0; i < 1000; ++i)
        values.push_back(i % 3 == 0 ? fill : static_cast<T>(i % 100));
    return statistics(row_of(type, values));
}

TEST(StatisticsTest, AFarValueIsNoData) {
    const auto expect_left_out = [](const Statistics& found, double fill) {
        EXPECT_EQ(found.no_data, fill);
        EXPECT_EQ(found.without_data, 334u);
        EXPECT_EQ(found.finite, 666u);
        EXPECT_EQ(found.minimum, 0);
        EXPECT_EQ(found.maximum, 99);
        EXPECT_NEAR(found.mean, 49.5, 0.1);
        EXPECT_NEAR(found.percentile(50), 49.5, 1);
        EXPECT_EQ(std::accumulate(found.histogram.begin(), found.histogram.end(), uint64_t{0}),
                  666u);
    };
    constexpr int32_t lowest = std::numeric_limits<int32_t>::min();
    expect_left_out(with_fill<int32_t>(VoxelType::i32, lowest), lowest);
    expect_left_out(with_fill<float>(VoxelType::f32, 1e30f), double(1e30f));
    expect_left_out(with_fill<double>(VoxelType::f64, -9999), -9999);
    expect_left_out(with_fill<int16_t>(VoxelType::i16, -32768), -32768);
    expect_left_out(with_fill<uint16_t>(VoxelType::u16, 65535), 65535);
    // Nearer ones, labels and constants are data.
    EXPECT_FALSE(with_fill<float>(VoxelType::f32, -500).no_data);
    EXPECT_FALSE(statistics(row_of<uint16_t>(VoxelType::u16, {0, 100, 101, 102, 0, 101})).no_data);
    EXPECT_FALSE(statistics(row_of<uint8_t>(VoxelType::u8, {0, 0, 255, 255})).no_data);
}

// Few voxels far from all others, or a long tail, leave percentiles and thresholds where they were.
TEST(StatisticsTest, OutliersDoNotMoveTheRest) {
    std::vector<float> values;
    for (int i = 0; i < 100000; ++i)
        values.push_back(float(i % 4 == 0 ? 200 + i % 41 : i % 41));  // two plateaus
    const Volume plain = row_of(VoxelType::f32, values);
    const Statistics before = statistics(plain);
    for (int i = 0; i < 5; ++i)
        values[size_t(1000 * i)] = 1e5F - 7e3F * float(i);
    const Volume hot = row_of(VoxelType::f32, values);
    const Statistics after = statistics(hot);
    EXPECT_FALSE(after.no_data);
    EXPECT_NEAR(after.maximum, 1e5, 1e-6);
    for (const double percent : {1.0, 25.0, 50.0, 90.0, 99.0})
        EXPECT_NEAR(after.percentile(percent), before.percentile(percent), 1) << percent;
    const double threshold = suggest_isovalue(hot, after);
    EXPECT_GT(threshold, 40);
    EXPECT_LT(threshold, 200);

    std::vector<double> tail;
    for (int i = 1; i <= 10000; ++i)
        tail.push_back(std::exp(20.0 * i / 10000));
    const Statistics skewed = statistics(row_of(VoxelType::f64, tail));
    for (const double percent : {10.0, 50.0, 99.0})
        EXPECT_NEAR(std::log(skewed.percentile(percent)), percent / 5, 0.01) << percent;
}

TEST(StatisticsTest, FormulasAreSampled) {
    const Statistics sphere = statistics(make_procedural("sphere:16"));
    EXPECT_EQ(sphere.finite, 4096u);
    EXPECT_GT(sphere.maximum, sphere.minimum);
    EXPECT_THROW(statistics(make_procedural("sphere:16"), 0), Error);
}

TEST(SuggestIsovalue, SeparatesTwoClasses) {
    std::vector<uint8_t> binary(1000, 0);
    std::fill(binary.begin() + 700, binary.end(), uint8_t{128});
    const Volume two = row_of(VoxelType::u8, binary);
    EXPECT_NEAR(suggest_isovalue(two, statistics(two)), 64, 0.5);

    std::vector<float> humps;
    for (int i = 0; i < 1000; ++i)
        humps.push_back(static_cast<float>(i % 20));
    for (int i = 0; i < 300; ++i)
        humps.push_back(static_cast<float>(200 + i % 30));
    const Volume bimodal = row_of(VoxelType::f32, humps);
    const double threshold = suggest_isovalue(bimodal, statistics(bimodal));
    EXPECT_GT(threshold, 19);
    EXPECT_LT(threshold, 200);

    const Volume constant = row_of<uint8_t>(VoxelType::u8, {5, 5, 5});
    EXPECT_EQ(suggest_isovalue(constant, statistics(constant)), 5);
}

// Otsu's own criterion by brute force over all thresholds of a small histogram.
TEST(SuggestIsovalue, MaximisesTheVarianceBetweenClasses) {
    const Volume volume = row_of(VoxelType::u8, noise<uint8_t>(5000));
    const Statistics known = statistics(volume, 256);
    const auto between = [&](double threshold) {
        double n0 = 0, n1 = 0, sum0 = 0, sum1 = 0;
        for (uint32_t i = 0; i < volume.dims[0]; ++i) {
            const double value = volume.value(i, 0, 0);
            (value < threshold ? n0 : n1) += 1;
            (value < threshold ? sum0 : sum1) += value;
        }
        return n0 == 0 || n1 == 0 ? 0 : n0 * n1 * std::pow(sum0 / n0 - sum1 / n1, 2);
    };
    double best = 0;
    for (int level = 0; level < 256; ++level)
        best = std::max(best, between(level));
    EXPECT_NEAR(between(suggest_isovalue(volume, known)), best, 1e-9 * best);
}

class Isovalues : public ::testing::Test {
protected:
    Isovalues() {
        std::vector<uint16_t> values(1001);
        std::iota(values.begin(), values.end(), uint16_t{0});
        volume = row_of(VoxelType::u16, values);
    }
    std::vector<double> parse(std::string_view text) { return parse_isovalues(text, volume); }
    Volume volume;
};

TEST_F(Isovalues, NumbersAndLists) {
    EXPECT_EQ(parse("300"), (std::vector<double>{300}));
    EXPECT_EQ(parse("200,600"), (std::vector<double>{200, 600}));
    EXPECT_EQ(parse(" -1.5e2 , +7 "), (std::vector<double>{-150, 7}));
}

TEST_F(Isovalues, RangesIncludeTheirEnd) {
    EXPECT_EQ(parse("200:1000:100"),
              (std::vector<double>{200, 300, 400, 500, 600, 700, 800, 900, 1000}));
    EXPECT_EQ(parse("0:0.3:0.1").size(), 4u);
    EXPECT_EQ(parse("1:2:0.4").size(), 3u);
    EXPECT_EQ(parse("5:5:1"), (std::vector<double>{5}));
    EXPECT_EQ(parse("3:1:-1"), (std::vector<double>{3, 2, 1}));
    EXPECT_EQ(parse("7, 1:3:1, 9"), (std::vector<double>{7, 1, 2, 3, 9}));
}

TEST_F(Isovalues, WordsOfTheData) {
    EXPECT_NEAR(parse("p99")[0], 990, 2);
    EXPECT_NEAR(parse("p0")[0], 0, 1);
    EXPECT_NEAR(parse("p100")[0], 1000, 1e-9);
    EXPECT_NEAR(parse("p12.5")[0], 125, 2);
    const Statistics known = statistics(volume);
    EXPECT_DOUBLE_EQ(parse("1.5sigma")[0], known.mean + 1.5 * known.standard_deviation);
    EXPECT_DOUBLE_EQ(parse("-1 sigma")[0], known.mean - known.standard_deviation);
    EXPECT_DOUBLE_EQ(parse("auto")[0], suggest_isovalue(volume, known));
    EXPECT_EQ(parse("auto,p50,3:4:1,2sigma").size(), 5u);
}

TEST_F(Isovalues, AutoOfAFormulaNeedsNoVoxels) {
    const Volume field = make_procedural("sphere:64");
    EXPECT_DOUBLE_EQ(parse_isovalues("auto", field)[0], suggest_isovalue(field, Statistics{}));
    EXPECT_TRUE(field.bytes.span().empty());
    EXPECT_EQ(parse_isovalues("p50", field).size(), 1u);
}

TEST_F(Isovalues, NumbersNeedNoStatistics) {
    Volume broken;  // whose statistics would throw
    EXPECT_EQ(parse_isovalues("1,2:4:1", broken).size(), 4u);
    EXPECT_THROW(parse_isovalues("p50", broken), Error);
}

TEST_F(Isovalues, ErrorsNameTheWord) {
    for (const char* word : {"",        "x",         "3x",    "nan",     "inf",
                             "p",       "p101",      "p-1",   "pp",      "sigma",
                             "xsigma",  "1:2",       "1:2:0", "1:2:-1",  "2:1:1",
                             "1:2:x",   "1:2:3:4",   "a:b:c", "0:100:1", "0:1e300:1e-300",
                             "0:1:nan", "auto auto", "1 2",   "1e999",   "AUTO"}) {
        const std::string message = error_of([&] { parse(std::string("5,") + word + ",6"); });
        EXPECT_NE(message.find(std::string("\"") + word + "\""), std::string::npos)
            << word << ": " << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
    }
    EXPECT_THROW(parse("1\n2"), Error);
    EXPECT_THROW(parse("5,"), Error);
    EXPECT_EQ(parse("1:32:1").size(), 32u);
    EXPECT_THROW(parse("1:33:1"), Error);
    EXPECT_THROW(parse("1:32:1,40"), Error);
    EXPECT_THROW(parse("1,1:32:1"), Error);
}

}  // namespace
}  // namespace isorast
