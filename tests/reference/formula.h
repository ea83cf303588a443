// SPDX-License-Identifier: MIT
// The truth for closed forms: a ray caster on the formulas of procedural volumes, in double
// precision and without any voxels. A step is at most |value - level| / (the steepest slope), so it
// cannot jump over the surface; the crossing is bisected.
#pragma once
#include <isorast/volume.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "reference/picture.h"

namespace reference {

struct Formula {
    std::function<double(const dvec3&)> value;  // over [-1, 1]^3
    double level, steepest;
};

inline Formula formula(isorast::Field::Kind kind) {
    using Kind = isorast::Field::Kind;
    constexpr double PI = std::numbers::pi;
    if (kind == Kind::sphere) return {[](const dvec3& p) { return 1 - glm::length(p); }, 0.25, 1};
    if (kind == Kind::torus)
        return {[](const dvec3& p) { return 0.25 - std::hypot(std::hypot(p.x, p.y) - 0.6, p.z); },
                0, 1};
    if (kind == Kind::gyroid)
        return {[](const dvec3& p) {
                    dvec3 s = glm::sin(2 * PI * p), c = glm::cos(2 * PI * p);
                    return s.x * c.y + s.y * c.z + s.z * c.x;
                },
                0, 2 * PI * std::sqrt(6.0)};
    // Marschner & Lobb 1994, f_M = 6, alpha = 0.25.
    return {[](const dvec3& p) {
                double ripple = std::cos(12 * PI * std::cos(PI / 2 * std::hypot(p.x, p.y)));
                return (1 - std::sin(PI / 2 * p.z) + 0.25 * (1 + ripple)) / 2.5;
            },
            0.5, std::hypot(PI / 5, 0.6 * PI * PI)};
}

// The formula of a procedural volume, in the volume's box.
class FormulaCaster {
public:
    explicit FormulaCaster(const isorast::Volume& volume)
        : formula_(formula(volume.field.value().kind)) {
        low_ = vector(volume.affine(0, 0, 0));
        auto spacing = volume.affine.spacing();
        for (int axis = 0; axis < 3; ++axis)
            size_[axis] = spacing[axis] * (volume.dims[axis] - 1);
        half_side_ = std::max({size_.x, size_.y, size_.z}) / 2;
    }

    std::optional<Hit> operator()(const Ray& world) const {
        auto range = clip({world.origin - low_, world.direction}, size_);
        if (!range) return std::nullopt;
        double speed = glm::length(world.direction) / half_side_ * formula_.steepest;
        double t = range->first, value = above_level(world.at(t));
        bool inside = value >= 0;
        while (t < range->second) {
            // The shortest step, 1/20000 of the box, keeps the number of steps at a touching ray
            // finite.
            double step = std::max(std::abs(value) / speed, 1e-4 * half_side_);
            double next = std::min(t + step, range->second);
            value = above_level(world.at(next));
            if ((value >= 0) != inside) return refine(world, t, next, inside);
            t = next;
        }
        return std::nullopt;
    }

    Picture render(const isorast::Camera& camera, isorast::Size size) const {
        return reference::render(camera, size, *this);
    }

private:
    double above_level(const dvec3& world) const {
        return formula_.value((world - low_ - size_ / 2.0) / half_side_) - formula_.level;
    }

    Hit refine(const Ray& ray, double low, double high, bool inside) const {
        for (int step = 0; step < 50; ++step) {
            double middle = 0.5 * (low + high);
            ((above_level(ray.at(middle)) >= 0) == inside ? low : high) = middle;
        }
        dvec3 gradient;
        for (int axis = 0; axis < 3; ++axis) {
            dvec3 step(0);
            step[axis] = 1e-5 * half_side_;
            gradient[axis] = above_level(ray.at(high) + step) - above_level(ray.at(high) - step);
        }
        return hit_with_gradient(high, gradient, ray, inside);
    }

    Formula formula_;
    dvec3 low_, size_;  // the box: axis-aligned, as make_procedural places it
    double half_side_;
};

}  // namespace reference
