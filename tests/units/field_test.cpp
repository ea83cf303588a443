// SPDX-License-Identifier: MIT
// The formulas against double precision, and the names that ask for them.
#include "volume/field.h"

#include <isorast/error.h>

#include <gtest/gtest.h>

#include <cstring>
#include <numbers>
#include <random>

namespace {

using namespace isorast;
using Kind = Field::Kind;
constexpr double PI = std::numbers::pi;

const std::array<std::string, 9> NAMES{
    "sphere", "torus", "gyroid", "marschner-lobb", "noise", "coral", "head", "vessels", "bone"};

float value_of(Kind kind, double x, double y, double z) {
    return field::field_value({}, uint32_t(kind), 6, 1, float(x), float(y), float(z));
}

TEST(Field, SineAndCosineAreExactTo2e7) {
    double worst = 0;
    for (int i = -1000000; i <= 1000000; ++i) {
        float x = float(i) * 1e-4f;
        worst = std::max(worst, std::abs(double(field::field_sin(x)) - std::sin(double(x))));
        worst = std::max(worst, std::abs(double(field::field_cos(x)) - std::cos(double(x))));
    }
    EXPECT_LE(worst, 2e-7);
}

double exact(Kind kind, double x, double y, double z) {
    double k = 2 * PI;
    if (kind == Kind::sphere) return 1 - std::hypot(x, y, z);
    if (kind == Kind::torus) return 0.25 - std::hypot(std::hypot(x, y) - 0.6, z);
    if (kind == Kind::gyroid)
        return std::sin(k * x) * std::cos(k * y) + std::sin(k * y) * std::cos(k * z) +
               std::sin(k * z) * std::cos(k * x);
    double ripple = std::cos(k * 6 * std::cos(PI / 2 * std::hypot(x, y)));
    return (1 - std::sin(PI / 2 * z) + 0.25 * (1 + ripple)) / (2 * (1 + 0.25));
}

TEST(Field, FormulasAgreeWithDoublePrecision) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> side(-1, 1);
    for (int i = 0; i < 100000; ++i) {
        float x = side(random), y = side(random), z = side(random);
        for (Kind kind : {Kind::sphere, Kind::torus, Kind::gyroid, Kind::marschner_lobb})
            ASSERT_NEAR(value_of(kind, x, y, z), exact(kind, x, y, z), 2e-6) << NAMES[size_t(kind)];
    }
}

TEST(Field, RangesHoldAndTheLevelIsCrossed) {
    for (size_t kind = 0; kind < NAMES.size(); ++kind) {
        Volume volume = make_procedural(NAMES[kind] + ":48");
        sample(volume);
        auto [lowest, highest] = field_range(Kind(kind));
        double level = field_isovalue(*volume.field), least = 1e9, most = -1e9;
        for (uint32_t k = 0; k < 48; ++k)
            for (uint32_t j = 0; j < 48; ++j)
                for (uint32_t i = 0; i < 48; ++i) {
                    least = std::min(least, volume.value(i, j, k));
                    most = std::max(most, volume.value(i, j, k));
                }
        EXPECT_GE(least, lowest) << NAMES[kind];
        EXPECT_LE(most, highest) << NAMES[kind];
        EXPECT_LT(least, level) << NAMES[kind];
        EXPECT_GT(most, level) << NAMES[kind];
    }
}

TEST(Field, TimeGoesOnSmoothlyWithinTheRangeAndReturns) {
    for (const std::string& name : NAMES) {
        const Volume still = [&] {
            Volume volume = make_procedural(name + ":24");
            sample(volume);
            return volume;
        }();
        std::vector<Volume> steps;
        for (uint32_t step = 0; step < 60; ++step) {
            steps.push_back(make_procedural(name + ":24:steps=60", step));
            EXPECT_EQ(steps.back().time_step, step);
            EXPECT_EQ(steps.back().time_steps, 60u);
            sample(steps.back());
        }
        // The first step is the formula without time, bit for bit.
        EXPECT_TRUE(std::ranges::equal(still.bytes.span(), steps[0].bytes.span())) << name;
        const auto [lowest, highest] = field_range(still.field->kind);
        double largest_change = 0;
        for (uint32_t step = 0; step < 60; ++step) {
            double change = 0;
            for (uint32_t i = 0; i < 24; ++i) {
                const double value = steps[step].value(i, 9, 7);
                change += std::abs(value - steps[(step + 1) % 60].value(i, 9, 7)) / 24;
                EXPECT_GE(value, lowest) << name;
                EXPECT_LE(value, highest) << name;
            }
            largest_change = std::max(largest_change, change);
        }
        EXPECT_GT(largest_change, 1e-3 * (highest - lowest)) << name;
        EXPECT_LT(largest_change, 0.06 * (highest - lowest)) << name;
    }
}

TEST(Field, NoiseIsContinuousAndDependsOnItsSeedAndOctaves) {
    for (double x = -1; x < 1; x += 0.001)
        EXPECT_NEAR(value_of(Kind::noise, x, 0.3, -0.2), value_of(Kind::noise, x + 1e-5, 0.3, -0.2),
                    2e-3);
    float a = field::field_value({}, field::FIELD_NOISE, 6, 1, 0.1f, 0.2f, 0.3f);
    EXPECT_NE(a, field::field_value({}, field::FIELD_NOISE, 6, 2, 0.1f, 0.2f, 0.3f));
    EXPECT_NE(a, field::field_value({}, field::FIELD_NOISE, 5, 1, 0.1f, 0.2f, 0.3f));
}

TEST(Field, SamplesLieInTheWorldWhereTheAffineSays) {
    Volume volume = make_procedural("sphere:9x17x5");
    sample(volume);
    EXPECT_EQ(volume.type, VoxelType::f32);
    EXPECT_EQ(volume.affine(0, 0, 0), (std::array<double, 3>{-0.5, -1, -0.25}));
    EXPECT_EQ(volume.affine(8, 16, 4), (std::array<double, 3>{0.5, 1, 0.25}));
    for (uint32_t k = 0; k < 5; ++k)
        for (uint32_t j = 0; j < 17; ++j)
            for (uint32_t i = 0; i < 9; ++i) {
                auto [x, y, z] = volume.affine(i, j, k);
                EXPECT_EQ(volume.value(i, j, k), value_of(Kind::sphere, x, y, z));
            }
}

TEST(Field, SpacingKeepsTheShape) {
    Volume volume = make_procedural("sphere:33x33x17:spacing=1,1,2");
    sample(volume);
    EXPECT_EQ(volume.affine.spacing(), (std::array<double, 3>{1, 1, 2}));
    EXPECT_FLOAT_EQ(float(volume.value(16, 16, 0)), 0);  // both are on the unit sphere
    EXPECT_FLOAT_EQ(float(volume.value(16, 0, 8)), 0);
    EXPECT_FLOAT_EQ(float(volume.value(16, 16, 4)), float(volume.value(16, 8, 8)));
}

TEST(Field, ASideOfOneIsAtZero) {
    Volume line = make_procedural("sphere:5x1x1"), point = make_procedural("gyroid:1");
    sample(line);
    sample(point);
    EXPECT_EQ(line.value(0, 0, 0), 0);
    EXPECT_EQ(line.value(2, 0, 0), 1);
    EXPECT_NEAR(point.value(0, 0, 0), 0, 1e-6);
}

TEST(Field, IntegerTypesRoundToTheNearestStep) {
    Volume exact_volume = make_procedural("torus:16");
    sample(exact_volume);
    for (std::string type : {"u8", "u16"}) {
        Volume volume = make_procedural("torus:16:type=" + type);
        sample(volume);
        double steps = type == "u8" ? 255 : 65535;
        EXPECT_DOUBLE_EQ(volume.slope * steps + volume.intercept, field_range(Kind::torus)[1]);
        for (uint32_t k = 0; k < 16; ++k)
            for (uint32_t i = 0; i < 16; ++i)
                EXPECT_NEAR(volume.value(i, 7, k), exact_volume.value(i, 7, k),
                            volume.slope * 0.51);
    }
}

TEST(Field, NamesAreRead) {
    Volume volume = make_procedural("noise:8x9x10:octaves=4:seed=7:type=u16:spacing=0.5,1,2.5");
    EXPECT_EQ(volume.dims, (std::array<uint32_t, 3>{8, 9, 10}));
    EXPECT_EQ(volume.field->kind, Kind::noise);
    EXPECT_EQ(volume.field->octaves, 4u);
    EXPECT_EQ(volume.field->seed, 7u);
    EXPECT_EQ(volume.type, VoxelType::u16);
    EXPECT_TRUE(volume.bytes.span().empty());
    for (const std::string& name : NAMES)
        EXPECT_TRUE(is_procedural(name + ":64"));
    for (std::string name : {"sphere", "sphere.raw", "cube:64", "a/sphere:64", "Sphere:64", ""})
        EXPECT_FALSE(is_procedural(name)) << name;
}

TEST(Field, ErrorsNameTheBadPart) {
    const std::vector<std::pair<std::string, std::string>> bad{
        {"cube:64", "\"cube\""},
        {"sphere", "none"},
        {"sphere:", "\"\""},
        {"sphere:0", "\"0\""},
        {"sphere:-3", "\"-3\""},
        {"sphere:64x64", "\"64x64\""},
        {"sphere:64x64x0x3", "\"64x64x0x3\""},
        {"sphere:99999999999", "\"99999999999\""},
        {"sphere:64:octaves=3", "\"octaves=3\""},
        {"sphere:64:", "\"\""},
        {"noise:64:octaves=0", "\"0\""},
        {"noise:64:octaves=17", "\"17\""},
        {"noise:64:seed=x", "\"x\""},
        {"noise:64:seed", "\"seed\""},
        {"noise:64:type=i32", "\"i32\""},
        {"noise:64:type=", "\"\""},
        {"noise:64:spacing=1,2", "\"1,2\""},
        {"noise:64:spacing=1,2,0", "\"1,2,0\""},
        {"noise:64:spacing=1,2,nan", "\"1,2,nan\""},
        {"noise:64:spacing=1,2,inf", "\"1,2,inf\""},
        {"noise:64:steps=0", "\"0\""},
        {"noise:64:steps=99999", "\"99999\""},
    };
    for (const auto& [name, part] : bad) {
        try {
            make_procedural(name);
            ADD_FAILURE() << name << " was accepted";
        } catch (const Error& error) {
            std::string message = error.what();
            EXPECT_TRUE(message.starts_with(name + ": expected ")) << message;
            EXPECT_TRUE(message.ends_with(part)) << message;
        }
    }
}

TEST(Field, ATypeThatNoFormulaHasIsRefused) {
    Volume volume = make_procedural("sphere:4");
    volume.type = VoxelType::i16;
    EXPECT_THROW(sample(volume), Error);
}

}  // namespace
