// SPDX-License-Identifier: MIT
// What a reference renderer sees: the rays of a camera, and hit, depth and normal of each pixel,
// all in double precision. A ray's parameter is the depth itself: distance from the eye's plane.
#pragma once
#include <isorast/camera.h>
#include <isorast/image.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <thread>
#include <vector>

namespace reference {

using glm::dvec3;

constexpr double INFINITE = std::numeric_limits<double>::infinity();

struct Ray {
    dvec3 origin, direction;  // direction . forward = 1
    dvec3 at(double t) const { return origin + t * direction; }
};

struct Hit {
    double depth = INFINITE;
    dvec3 normal{0, 0, 0};  // world space, unit length, on the viewer's side of the surface
};

// A hit where the ray crosses the surface into higher values, or out of them (`leaving`). A normal
// by central differences can point away from the eye all the same: then it is turned back until it
// is edge-on.
inline Hit hit_with_gradient(double depth, const dvec3& gradient, const Ray& ray, bool leaving) {
    dvec3 towards = -glm::normalize(ray.direction);
    double length = glm::length(gradient);
    if (length == 0) return {depth, towards};
    dvec3 normal = (leaving ? 1 : -1) / length * gradient;
    double facing = glm::dot(normal, towards);
    return {depth, facing < 0 ? glm::normalize(normal - facing * towards) : normal};
}

struct Picture {
    isorast::Size size;
    std::vector<Hit> hits;  // rows from the top
    // Whether rays hit everywhere in and just around a pixel; the caster must still live. May be
    // empty.
    std::function<bool(uint32_t x, uint32_t y)> solid = {};
    const Hit& at(uint32_t x, uint32_t y) const { return hits[size_t{y} * size.width + x]; }
};

inline dvec3 vector(const std::array<double, 3>& v) {
    return {v[0], v[1], v[2]};
}

class Rays {
public:
    Rays(const isorast::Camera& camera, isorast::Size size) : camera_(camera), size_(size) {
        eye_ = vector(camera.position);
        forward_ = glm::normalize(vector(camera.target) - eye_);
        right_ = glm::normalize(glm::cross(forward_, vector(camera.up)));
        up_ = glm::cross(right_, forward_);
    }

    // The ray through the point (x, y) of the picture, in pixels from the top left corner.
    Ray through(double x, double y) const {
        double half_side = std::min(size_.width, size_.height) / 2.0;
        double across = (x - size_.width / 2.0) / half_side;
        double upwards = (size_.height / 2.0 - y) / half_side;
        dvec3 offset = across * right_ + upwards * up_;
        if (camera_.orthographic) return {eye_ + camera_.height / 2 * offset, forward_};
        return {eye_, forward_ + std::tan(glm::radians(camera_.fov_degrees) / 2) * offset};
    }

private:
    isorast::Camera camera_;
    isorast::Size size_;
    dvec3 eye_, forward_, right_, up_;
};

// Casts the ray through each pixel's middle; `cast` is called from several threads.
template <typename Cast>
Picture render(const isorast::Camera& camera, isorast::Size size, const Cast& cast) {
    Picture picture{size, std::vector<Hit>(size_t{size.width} * size.height)};
    Rays rays(camera, size);
    uint32_t workers = std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::jthread> threads;
    for (uint32_t worker = 0; worker < workers; ++worker) {
        threads.emplace_back([&, worker] {
            for (uint32_t y = worker; y < size.height; y += workers)
                for (uint32_t x = 0; x < size.width; ++x) {
                    std::optional<Hit> hit = cast(rays.through(x + 0.5, y + 0.5));
                    if (hit) picture.hits[size_t{y} * size.width + x] = *hit;
                }
        });
    }
    threads.clear();  // joins
    picture.solid = [rays, &cast](uint32_t x, uint32_t y) {
        for (double v = y - 0.2; v < y + 1.2; v += 0.1)
            for (double u = x - 0.2; u < x + 1.2; u += 0.1)
                if (!cast(rays.through(u, v))) return false;
        return true;
    };
    return picture;
}

// The part of the ray in front of the eye's plane and inside the box from 0 to `top`; nothing when
// empty.
inline std::optional<std::pair<double, double>> clip(const Ray& ray, const dvec3& top) {
    double enter = 0, leave = INFINITE;
    for (int axis = 0; axis < 3; ++axis) {
        double o = ray.origin[axis], d = ray.direction[axis];
        if (d == 0 && (o < 0 || o > top[axis])) return std::nullopt;
        if (d == 0) continue;
        double a = -o / d, b = (top[axis] - o) / d;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    if (!(enter < leave)) return std::nullopt;
    return std::pair(enter, leave);
}

}  // namespace reference
