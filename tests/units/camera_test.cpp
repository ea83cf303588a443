// SPDX-License-Identifier: MIT
// Cameras that fit a volume: everything in view, tight, unmirrored, finite.
#include <gtest/gtest.h>
#include <isorast/camera.h>
#include <isorast/error.h>
#include <isorast/volume.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace isorast {
namespace {

using glm::dvec3;

dvec3 vec(const std::array<double, 3>& v) {
    return {v[0], v[1], v[2]};
}

Volume volume_of(std::array<uint32_t, 3> dims, const Affine& affine, Space space = Space::unknown) {
    Volume volume;
    volume.name = "test";
    volume.dims = dims;
    volume.affine = affine;
    volume.space = space;
    return volume;
}

// x to the right, y upwards, each -1 to 1 across the shorter side of the picture, and depth.
struct Projected {
    double x, y, depth;
};

Projected project(const Camera& camera, const dvec3& world) {
    const dvec3 forward = glm::normalize(vec(camera.target) - vec(camera.position));
    const dvec3 right = glm::normalize(glm::cross(forward, vec(camera.up)));
    const dvec3 up = glm::cross(right, forward);
    const dvec3 p = world - vec(camera.position);
    const double depth = glm::dot(p, forward);
    const double half = camera.orthographic
                            ? camera.height / 2
                            : depth * std::tan(glm::radians(camera.fov_degrees) / 2);
    return {glm::dot(p, right) / half, glm::dot(p, up) / half, depth};
}

std::vector<dvec3> corners(const Volume& volume) {
    std::vector<dvec3> result;
    for (int c = 0; c < 8; ++c) {
        result.push_back(vec(volume.affine(c & 1 ? volume.dims[0] - 1.0 : 0.0,
                                           c & 2 ? volume.dims[1] - 1.0 : 0.0,
                                           c & 4 ? volume.dims[2] - 1.0 : 0.0)));
    }
    return result;
}

// The largest |x| or |y| of any corner; every corner must lie in front of the eye.
double reach(const Camera& camera, const Volume& volume) {
    double largest = 0;
    for (const dvec3& corner : corners(volume)) {
        const Projected p = project(camera, corner);
        EXPECT_GT(p.depth, 0);
        largest = std::max({largest, std::abs(p.x), std::abs(p.y)});
    }
    return largest;
}

void expect_finite(const Camera& camera) {
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_TRUE(std::isfinite(camera.position[axis]));
        EXPECT_TRUE(std::isfinite(camera.up[axis]));
    }
    EXPECT_GT(glm::distance(vec(camera.position), vec(camera.target)), 0);
    EXPECT_NEAR(glm::length(vec(camera.up)), 1, 1e-12);
    EXPECT_NEAR(glm::dot(vec(camera.up), vec(camera.position) - vec(camera.target)), 0, 1e-6);
    EXPECT_GT(camera.height, 0);
}

std::vector<Volume> various_volumes() {
    std::vector<Volume> volumes;
    volumes.push_back(volume_of({64, 64, 64}, Affine::scaling(1, 1, 1)));
    volumes.push_back(volume_of({256, 128, 20}, Affine::scaling(0.4, 0.4, 5), Space::ras));
    volumes.push_back(
        volume_of({10, 400, 30}, {{{{-2, 0, 0, 90}, {0, 3, 0, -126}, {0, 0, 1, -72}}}}));
    const Affine oblique{{{{0.8, -0.6, 0, 1e4}, {0.6, 0.8, 0.3, -50}, {0, 0.1, 2, 7}}}};
    volumes.push_back(volume_of({50, 60, 70}, oblique, Space::ras));
    const Affine sheared{{{{1, 0.7, -0.4, 0}, {0, 1, 0.9, 0}, {0, 0, 1, 0}}}};
    volumes.push_back(volume_of({33, 17, 65}, sheared));
    return volumes;
}

TEST(Camera, FitIsCompleteAndTightFromEverywhere) {
    for (const Volume& volume : various_volumes()) {
        for (int azimuth = -180; azimuth < 360; azimuth += 25) {
            for (int elevation = -90; elevation <= 90; elevation += 15) {
                for (bool orthographic : {false, true}) {
                    for (double fov : {5.0, 30.0, 100.0}) {
                        const Camera camera = orbit(volume, azimuth, elevation,
                                                    {.roll_degrees = azimuth / 3.0,
                                                     .fov_degrees = fov,
                                                     .orthographic = orthographic});
                        expect_finite(camera);
                        ASSERT_NEAR(reach(camera, volume), 0.96, 1e-6)
                            << azimuth << ' ' << elevation;
                    }
                }
            }
        }
    }
}

TEST(Camera, ThinVolumesStayFinite) {
    const std::array<uint32_t, 3> all_dims[] = {{1, 1, 1}, {1, 64, 64}, {64, 1, 1}, {1, 1, 500}};
    for (const auto& dims : all_dims) {
        const Volume volume = volume_of(dims, Affine::scaling(1, 2, 3));
        for (int azimuth : {0, 45, 90}) {
            for (int elevation : {0, 20, 90, -90}) {
                for (bool orthographic : {false, true}) {
                    const Camera camera =
                        orbit(volume, azimuth, elevation, {.orthographic = orthographic});
                    expect_finite(camera);
                    EXPECT_LE(reach(camera, volume), 0.961);
                }
            }
        }
    }
}

TEST(Camera, RealAspectIsKept) {
    // 100 voxels of 1 against 20 voxels of 5: about as tall as wide, whatever the voxel counts say.
    const Volume volume = volume_of({101, 101, 21}, Affine::scaling(1, 1, 5));
    const Camera camera = orbit(volume, 0, 0, {.orthographic = true});
    const Projected low = project(camera, {0, 0, 0}), high = project(camera, {100, 0, 100});
    EXPECT_NEAR(std::abs(high.x - low.x), high.y - low.y, 1e-12);
    EXPECT_NEAR(high.y - low.y, 1.92, 1e-12);
}

TEST(Camera, ZoomDoublesSizesAndKeepsTheEye) {
    const Volume volume = volume_of({64, 32, 16}, Affine::scaling(1, 1, 1));
    for (bool orthographic : {false, true}) {
        const Camera once = orbit(volume, 30, 20, {.orthographic = orthographic});
        const Camera twice = orbit(volume, 30, 20, {.zoom = 2, .orthographic = orthographic});
        EXPECT_EQ(once.position, twice.position);
        const dvec3 corner(63, 0, 15);
        EXPECT_NEAR(project(twice, corner).x, 2 * project(once, corner).x, 1e-9);
        EXPECT_NEAR(project(twice, corner).y, 2 * project(once, corner).y, 1e-9);
    }
    EXPECT_THROW(orbit(volume, 0, 0, {.zoom = 0}), Error);
    EXPECT_THROW(orbit(volume, 0, 0, {.fov_degrees = 180}), Error);
    EXPECT_THROW(orbit(volume, 0, std::nan("")), Error);
    EXPECT_THROW(orbit(volume, 0, 0, {.roll_degrees = INFINITY}), Error);
}

TEST(Camera, RollTurnsThePictureCounterClockwise) {
    const Volume volume = volume_of({65, 65, 65}, Affine::scaling(1, 1, 1));
    const Camera upright = orbit(volume, 0, 0, {.orthographic = true});
    const Camera rolled = orbit(volume, 0, 0, {.roll_degrees = 90, .orthographic = true});
    const Projected top = project(upright, {32, 32, 64}), left = project(rolled, {32, 32, 64});
    EXPECT_NEAR(top.x, 0, 1e-12);
    EXPECT_GT(top.y, 0.9);
    EXPECT_LT(left.x, -0.9);
    EXPECT_NEAR(left.y, 0, 1e-12);
}

TEST(Camera, AzimuthAndElevationStartAtTheFront) {
    const Volume plain = volume_of({65, 65, 65}, Affine::scaling(1, 1, 1));
    const Volume patient = volume_of({65, 65, 65}, Affine::scaling(1, 1, 1), Space::ras);
    EXPECT_LT(orbit(plain, 0, 0).position[1], -64);
    EXPECT_GT(orbit(patient, 0, 0).position[1], 128);
    EXPECT_GT(orbit(plain, 90, 0).position[0], 128);  // counter-clockwise, seen from above
    EXPECT_GT(orbit(plain, 0, 90).position[2], 128);
    EXPECT_LT(orbit(plain, 0, -90).position[2], -64);
    // From the poles, up continues what it was on the way there.
    const Camera top = orbit(plain, 0, 90), nearly = orbit(plain, 0, 89.999);
    EXPECT_NEAR(glm::distance(vec(top.up), vec(nearly.up)), 0, 1e-4);
}

TEST(Camera, PresetsLookFromTheirSide) {
    const Volume volume = volume_of({11, 21, 31}, Affine::scaling(1, 1, 1), Space::ras);
    const dvec3 middle(5, 10, 15);
    struct Case {
        const char *axis, *patient;
        dvec3 from, right;
    };
    const Case cases[] = {
        {"+x", "R", {1, 0, 0}, {0, 1, 0}},  {"-x", "L", {-1, 0, 0}, {0, -1, 0}},
        {"+y", "A", {0, 1, 0}, {-1, 0, 0}}, {"-y", "P", {0, -1, 0}, {1, 0, 0}},
        {"+z", "S", {0, 0, 1}, {1, 0, 0}},  {"-z", "I", {0, 0, -1}, {-1, 0, 0}},
    };
    for (const Case& c : cases) {
        const auto camera = view_preset(volume, c.axis);
        ASSERT_TRUE(camera) << c.axis;
        const dvec3 eye = glm::normalize(vec(camera->position) - middle);
        EXPECT_NEAR(glm::dot(eye, c.from), 1, 1e-12) << c.axis;
        EXPECT_GT(project(*camera, middle + c.right).x, 0) << c.axis;
        EXPECT_NEAR(reach(*camera, volume), 0.96, 1e-9);
        EXPECT_EQ(view_preset(volume, c.patient)->position, camera->position);
    }
    EXPECT_FALSE(view_preset(volume, "x"));
    EXPECT_FALSE(view_preset(volume, "front"));
}

TEST(Camera, PatientSidesNeedAPatientSpace) {
    const Volume volume = volume_of({8, 8, 8}, Affine::scaling(1, 1, 1));
    EXPECT_TRUE(view_preset(volume, "+x"));
    EXPECT_THROW(view_preset(volume, "A"), Error);
}

TEST(Camera, LeftHandedVoxelAxesAreNotMirrored) {
    // The same world box, once with voxel rows from right to left: the cameras must be the same.
    const Volume ras = volume_of({11, 21, 31}, Affine::scaling(1, 1, 1), Space::ras);
    const Affine flipped{{{{-1, 0, 0, 10}, {0, 1, 0, 0}, {0, 0, 1, 0}}}};
    const Volume las = volume_of({11, 21, 31}, flipped, Space::ras);
    ASSERT_LT(las.affine.determinant(), 0);
    const Camera a = orbit(ras, 30, 20), b = orbit(las, 30, 20);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(a.position[axis], b.position[axis], 1e-9);
        EXPECT_NEAR(a.up[axis], b.up[axis], 1e-12);
    }
    // Seen from the front, the patient's left is on the right of the picture.
    EXPECT_GT(project(*view_preset(las, "A"), dvec3(0, 10, 15)).x, 0);
}

}  // namespace
}  // namespace isorast
