// SPDX-License-Identifier: MIT
// The grid's arithmetic, without a GPU: bricks cover every cell with its apron, and stored values
// keep the order and the ties of data values.
#include <gtest/gtest.h>
#include <isorast/error.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "grid/bricks.h"
#include "grid/stored.h"

namespace {

using namespace isorast;

// Every voxel that a cell of the brick or its gradients touch must be in the brick.
void expect_covered(const BrickPlan& plan, uint32_t max_side, uint64_t max_bytes,
                    uint32_t voxel_bytes) {
    for (uint32_t i = 0; i < plan.count(); ++i) {
        const glm::uvec3 first = plan.where(i) * plan.brick_cells, origin = plan.origin(i);
        const glm::uvec3 extent = plan.extent(i);
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_LT(first[axis] + 1, plan.voxels[axis]) << "a brick without cells";
            EXPECT_LE(extent[axis], max_side);
            EXPECT_EQ(origin[axis], first[axis] == 0 ? 0 : first[axis] - 1);
            const uint32_t last =
                std::min(first[axis] + plan.brick_cells[axis] + 1, plan.voxels[axis] - 1);
            EXPECT_EQ(origin[axis] + extent[axis] - 1, last);
        }
        EXPECT_LE(uint64_t{extent.x} * extent.y * extent.z * voxel_bytes, max_bytes);
    }
    // The last bricks reach the last cells.
    EXPECT_TRUE(glm::all(glm::greaterThanEqual(plan.bricks * plan.brick_cells, plan.voxels - 1u)));
}

TEST(Bricks, OneWhereItFits) {
    EXPECT_TRUE(plan_bricks({256, 100, 3}, 1, 2048, 1u << 30).one());
    EXPECT_TRUE(plan_bricks({1, 1, 1}, 4, 2048, 1u << 30).one());
}

TEST(Bricks, CoverEveryCellWithinTheLimits) {
    for (const glm::uvec3 voxels :
         {glm::uvec3(64), glm::uvec3(65, 100, 33), glm::uvec3(300, 20, 41)})
        for (const uint32_t side : {11u, 24u, 40u, 64u})
            for (const uint64_t bytes : {uint64_t{5000}, uint64_t{100000}, uint64_t{1} << 30}) {
                const BrickPlan plan = plan_bricks(voxels, 2, side, bytes);
                expect_covered(plan, side, bytes, 2);
            }
}

TEST(Bricks, ManyGigabytes) {
    const BrickPlan plan = plan_bricks(glm::uvec3(4097), 2, 16384, uint64_t{4} << 30);
    expect_covered(plan, 16384, uint64_t{4} << 30, 2);
    EXPECT_LE(plan.count(), 64u);
    EXPECT_GE(plan.count(), 32u);
}

TEST(Bricks, ATooSmallSideIsAnError) {
    EXPECT_THROW(plan_bricks(glm::uvec3(64), 1, 10, 1u << 30), Error);
}

template <class T>
Volume volume_of(const std::vector<T>& values, VoxelType type, double slope = 1,
                 double intercept = 0) {
    Volume volume;
    volume.dims = {uint32_t(values.size()), 1, 1};
    volume.type = type;
    std::vector<std::byte> bytes(values.size() * sizeof(T));
    std::memcpy(bytes.data(), values.data(), bytes.size());
    volume.bytes = VoxelBytes::own(std::move(bytes));
    volume.slope = slope;
    volume.intercept = intercept;
    return volume;
}

// What the GPU will hold, as numbers.
std::vector<double> stored_values(const Volume& volume) {
    const Stored stored = stored_as(volume);
    const uint32_t count = volume.dims[0];
    std::vector<std::byte> bytes(size_t{count} * stored.bytes());
    StoredRange range;
    store_voxels(volume, stored, 0, count, bytes.data(), range);
    std::vector<double> values(count);
    for (uint32_t i = 0; i < count; ++i) {
        if (stored.bits == 8) values[i] = double(uint8_t(bytes[i]));
        if (stored.bits == 16) values[i] = reinterpret_cast<const uint16_t*>(bytes.data())[i];
        if (stored.bits == 32) values[i] = double(reinterpret_cast<const float*>(bytes.data())[i]);
    }
    return values;
}

// value >= isovalue must hold for a stored voxel exactly when it holds for the data, ties too.
void expect_same_order(const Volume& volume) {
    const Stored stored = stored_as(volume);
    const std::vector<double> values = stored_values(volume);
    for (uint32_t i = 0; i < volume.dims[0]; ++i) {
        EXPECT_NEAR(stored.value(values[i]), volume.value(i, 0, 0),
                    1e-6 * std::abs(volume.value(i, 0, 0)));
        for (uint32_t j = 0; j < volume.dims[0]; ++j) {
            const double isovalue = volume.value(j, 0, 0);
            EXPECT_EQ(values[i] >= double(stored.from_value(isovalue)),
                      volume.value(i, 0, 0) >= isovalue)
                << name_of(volume.type) << " slope " << volume.slope << ": "
                << volume.value(i, 0, 0) << " against " << isovalue;
        }
    }
}

TEST(Stored, KeepsOrderAndTies) {
    for (const double slope : {1.0, -1.0, 0.25, -2.0}) {
        expect_same_order(volume_of<uint8_t>({0, 1, 127, 128, 254, 255}, VoxelType::u8, slope, -3));
        expect_same_order(volume_of<int8_t>({-128, -127, -1, 0, 1, 127}, VoxelType::i8, slope, 8));
        expect_same_order(
            volume_of<uint16_t>({0, 1, 256, 32767, 32768, 65535}, VoxelType::u16, slope));
        expect_same_order(volume_of<int16_t>({-32768, -1024, -1, 0, 1, 3071, 32767}, VoxelType::i16,
                                             slope, -1024));
        expect_same_order(
            volume_of<uint32_t>({4000000000u, 4000000001u, 4000000017u}, VoxelType::u32, slope));
        expect_same_order(
            volume_of<int32_t>({-2000000000, -1999999999, -1999999000}, VoxelType::i32, slope));
        expect_same_order(volume_of<float>({-2.5f, -0.0f, 0.125f, 1e6f}, VoxelType::f32, slope));
        expect_same_order(volume_of<double>({1e9, 1e9 + 0.5, 1e9 + 64}, VoxelType::f64, slope));
    }
}

TEST(Stored, NotFiniteIsOutsideOfEverything) {
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                inf = std::numeric_limits<float>::infinity();
    const auto values = stored_values(volume_of<float>({nan, inf, -inf, 1.0f}, VoxelType::f32));
    for (int i = 0; i < 3; ++i)
        EXPECT_EQ(values[i], double(NOT_FINITE));
    EXPECT_EQ(values[3], 1.0);
}

TEST(Stored, TheRangeIsThatOfTheFiniteFloats) {
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                inf = std::numeric_limits<float>::infinity(),
                largest = std::numeric_limits<float>::max();
    const auto range_of = [](const std::vector<float>& values, double slope = 1) {
        const Volume volume = volume_of<float>(values, VoxelType::f32, slope);
        std::vector<std::byte> bytes(volume.byte_count());
        StoredRange range;
        const Stored stored = stored_as(volume);
        store_voxels(volume, stored, 0, volume.dims[0], bytes.data(), range);
        return std::pair(float(stored.value(double(range.least))),
                         float(stored.value(double(range.greatest))));
    };
    EXPECT_EQ(range_of({nan, -5, 3, inf, -0.0f}), std::pair(-5.0f, 3.0f));
    EXPECT_EQ(range_of({nan, -5, 3, inf, -0.0f}, -2), std::pair(-6.0f, 10.0f));
    EXPECT_EQ(range_of({-1e-40f, 1e-40f, -1e-42f}), std::pair(-1e-40f, 1e-40f));
    EXPECT_EQ(range_of({largest, -largest, -inf}), std::pair(-largest, largest));
    const auto [least, greatest] = range_of({nan, inf, -inf});
    EXPECT_GT(least, greatest);
}

// "No data" far from all others, at the least or the greatest value, costs them no digits.
TEST(Stored, FillValuesLeaveTheOthersExact) {
    for (const double fill : {-1e300, -1e20, -1e9, 1e9, 1e20, 1e300}) {
        std::vector<double> data(20, fill);
        for (const double value : {0.0, 0.25, 30.5, 30.5000001, 31.0, 60.0, 91.0})
            data.push_back(value);
        const Volume volume = volume_of<double>(data, VoxelType::f64);
        const auto values = stored_values(volume);
        const Stored stored = stored_as(volume);
        for (size_t i = 20; i < data.size(); ++i)
            EXPECT_NEAR(stored.value(values[i]), data[i], 1e-5) << fill;
        EXPECT_EQ(values[0] < values[20], fill < 0);
        EXPECT_EQ(values[0] > values.back(), fill > 0);
        EXPECT_LT(values[22], values[23]);
    }
    expect_same_order(volume_of<int32_t>(
        {std::numeric_limits<int32_t>::min(), 0, 1, 2, 3, 1000, 1001}, VoxelType::i32));
}

// Squares and products of stored values must be floats, or nothing is shaded.
TEST(Stored, ValuesFarFromOneBecomeNearer) {
    for (const int exponent : {-300, -60, -35, -20, 20, 35, 60, 300}) {
        const double unit = std::pow(10.0, exponent);
        std::vector<double> data{0, unit, 2 * unit, 3 * unit, 10 * unit};
        const auto doubles = stored_values(volume_of<double>(data, VoxelType::f64));
        EXPECT_GT(doubles[2] - doubles[1], 1e-9) << exponent;
        EXPECT_LT(doubles[2] - doubles[1], 1e9) << exponent;
        if (std::abs(exponent) > 35) continue;
        std::vector<float> floats;
        for (const double value : data)
            floats.push_back(float(value));
        const Volume volume = volume_of<float>(floats, VoxelType::f32);
        const auto values = stored_values(volume);
        const Stored stored = stored_as(volume);
        EXPECT_GT(values[2] - values[1], 1e-9) << exponent;
        EXPECT_LT(values[2] - values[1], 1e9) << exponent;
        for (size_t i = 0; i < values.size(); ++i)
            EXPECT_EQ(float(stored.value(values[i])), floats[i]) << exponent;
    }
}

}  // namespace
