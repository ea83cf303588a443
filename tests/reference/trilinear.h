// SPDX-License-Identifier: MIT
// The truth for any volume: a ray caster on the trilinear field in double precision. Along a ray
// the field is a cubic in each cell; it is split at its extrema, so that each piece has at most one
// crossing, which is bisected (Marmitt et al., "Fast and accurate ray-voxel intersection
// techniques", 2004). Blocks of 8^3 cells that the isovalue does not cross are skipped.
#pragma once
#include <isorast/volume.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "reference/picture.h"

namespace reference {

using Cubic = std::array<double, 4>;  // c[0] + c[1] u + c[2] u^2 + c[3] u^3

inline double evaluate(const Cubic& c, double u) {
    return ((c[3] * u + c[2]) * u + c[1]) * u + c[0];
}

// The first u in [0, 1] where the cubic changes between inside (>= 0) and outside, where the ray
// comes from `inside`.
inline std::optional<double> first_crossing(const Cubic& c, bool inside) {
    std::array<double, 4> ends{0, 1, 1, 1};
    int count = 1;
    double a = 3 * c[3], b = 2 * c[2], discriminant = b * b - 4 * a * c[1];
    if (discriminant > 0) {
        // The form that does not cancel; a = 0 gives an infinite root, which is dropped.
        double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
        std::array<double, 2> roots{q / a, c[1] / q};
        std::sort(roots.begin(), roots.end());
        for (double root : roots)
            if (root > 0 && root < 1) ends[count++] = root;
    }
    if ((c[0] >= 0) != inside) return 0;
    for (int i = 0; i < count; ++i) {
        double low = ends[i], high = i + 1 < count ? ends[i + 1] : 1;
        if ((evaluate(c, high) >= 0) == inside) continue;
        for (int step = 0; step < 60; ++step) {
            double middle = 0.5 * (low + high);
            ((evaluate(c, middle) >= 0) == inside ? low : high) = middle;
        }
        return high;
    }
    return std::nullopt;
}

// Calls visit(cell, enter, leave) for each cell of edge length `side` that the ray passes through
// from t = enter to t = leave, in order, until it returns true.
template <typename Visit>
void walk(const Ray& ray, double enter, double leave, int side, const glm::ivec3& lowest,
          const glm::ivec3& highest, const Visit& visit) {
    dvec3 start = ray.at(enter) / double(side), next;
    glm::ivec3 cell, step;
    dvec3 delta;
    for (int axis = 0; axis < 3; ++axis) {
        double d = ray.direction[axis];
        cell[axis] = std::clamp(int(std::floor(start[axis])), lowest[axis], highest[axis]);
        step[axis] = d < 0 ? -1 : 1;
        delta[axis] = d != 0 ? side / std::abs(d) : INFINITE;
        double border = side * (cell[axis] + (d < 0 ? 0.0 : 1.0));
        next[axis] = d != 0 ? (border - ray.origin[axis]) / d : INFINITE;
    }
    double t = enter;
    while (t < leave) {
        int axis = next.x < next.y ? (next.x < next.z ? 0 : 2) : (next.y < next.z ? 1 : 2);
        double end = std::clamp(next[axis], t, leave);
        if (visit(cell, t, end)) return;
        t = end;
        cell[axis] += step[axis];
        next[axis] += delta[axis];
        if (cell[axis] < lowest[axis] || cell[axis] > highest[axis]) return;
    }
}

class TrilinearCaster {
public:
    static constexpr int BLOCK = 8;

    // The volume must be sampled; isovalues are in data units. A cell with a voxel that is not
    // finite is empty.
    TrilinearCaster(const isorast::Volume& volume, std::vector<double> isovalues)
        : isovalues_(std::move(isovalues)) {
        for (int axis = 0; axis < 3; ++axis) {
            dims_[axis] = int(volume.dims[axis]);
            for (int row = 0; row < 3; ++row)
                linear_[axis][row] = volume.affine.m[row][axis];
            origin_[axis] = volume.affine.m[axis][3];
        }
        inverse_ = glm::inverse(linear_);
        values_.reserve(volume.voxel_count());
        for (uint32_t k = 0; k < volume.dims[2]; ++k)
            for (uint32_t j = 0; j < volume.dims[1]; ++j)
                for (uint32_t i = 0; i < volume.dims[0]; ++i)
                    values_.push_back(volume.value(i, j, k));
        blocks_ = (dims_ - 2 + BLOCK) / BLOCK;
        if (cells().x > 0 && cells().y > 0 && cells().z > 0) classify_blocks();
    }

    // The nearest crossing of any isovalue.
    std::optional<Hit> operator()(const Ray& world) const {
        Ray ray{inverse_ * (world.origin - origin_), inverse_ * world.direction};
        auto range = clip(ray, dvec3(dims_ - 1));
        if (!range || kinds_.empty()) return std::nullopt;
        Crossing nearest;
        for (size_t surface = 0; surface < isovalues_.size(); ++surface) {
            Crossing crossing = first_hit(ray, *range, surface);
            if (crossing.depth < nearest.depth) nearest = crossing;
        }
        if (nearest.depth == INFINITE) return std::nullopt;
        dvec3 gradient_there = glm::transpose(inverse_) * gradient(ray.at(nearest.depth));
        return hit_with_gradient(nearest.depth, gradient_there, world, nearest.leaving);
    }

    Picture render(const isorast::Camera& camera, isorast::Size size) const {
        return reference::render(camera, size, *this);
    }

    // Trilinear, at a position in voxels; outside the box the nearest position in it counts.
    double value(dvec3 p) const {
        p = glm::clamp(p, dvec3(0), dvec3(dims_ - 1));
        glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(p)), glm::ivec3(0), cells() - 1);
        auto corners = corners_of(cell);
        dvec3 f = p - dvec3(cell);
        double sum = 0;
        for (int c = 0; c < 8; ++c)
            sum += corners[c] * (c & 1 ? f.x : 1 - f.x) * (c & 2 ? f.y : 1 - f.y) *
                   (c & 4 ? f.z : 1 - f.z);
        return sum;
    }

    // Central differences over two voxels, as renderers of volumes do; one-sided at the box.
    dvec3 gradient(const dvec3& p) const {
        dvec3 g;
        for (int axis = 0; axis < 3; ++axis) {
            dvec3 above = p, below = p;
            above[axis] = std::min(p[axis] + 1, dims_[axis] - 1.0);
            below[axis] = std::max(p[axis] - 1, 0.0);
            g[axis] = (value(above) - value(below)) / (above[axis] - below[axis]);
        }
        return g;
    }

private:
    struct Crossing {
        double depth = INFINITE;
        bool leaving = false;  // from inside to outside
    };

    glm::ivec3 cells() const { return dims_ - 1; }

    std::array<double, 8> corners_of(const glm::ivec3& cell) const {
        std::array<double, 8> corners;
        for (int c = 0; c < 8; ++c) {
            glm::ivec3 voxel = cell + glm::ivec3(c & 1, c >> 1 & 1, c >> 2);
            corners[c] = values_[(size_t(voxel.z) * dims_.y + voxel.y) * dims_.x + voxel.x];
        }
        return corners;
    }

    enum class Block : uint8_t { unknown, outside, inside, crossed, holed };

    // What each block is to each isovalue. `holed`: not crossed, but with voxels that are not
    // finite.
    void classify_blocks() {
        size_t count = size_t(blocks_.x) * blocks_.y * blocks_.z;
        kinds_.assign(isovalues_.size(), std::vector<Block>(count, Block::unknown));
        glm::ivec3 cell;
        for (cell.z = 0; cell.z < cells().z; ++cell.z)
            for (cell.y = 0; cell.y < cells().y; ++cell.y)
                for (cell.x = 0; cell.x < cells().x; ++cell.x)
                    for (size_t surface = 0; surface < isovalues_.size(); ++surface) {
                        Block& kind = kinds_[surface][block_index(cell / BLOCK)];
                        Block found = classify(corners_of(cell), isovalues_[surface]);
                        if (kind == Block::unknown || found == Block::crossed) kind = found;
                        if (kind != Block::crossed && kind != found) kind = Block::holed;
                    }
    }

    static Block classify(const std::array<double, 8>& corners, double isovalue) {
        if (!finite(corners)) return Block::holed;
        auto [low, high] = std::minmax_element(corners.begin(), corners.end());
        if (*low >= isovalue) return Block::inside;
        return *high < isovalue ? Block::outside : Block::crossed;
    }

    static bool finite(const std::array<double, 8>& corners) {
        return std::all_of(corners.begin(), corners.end(),
                           [](double v) { return std::isfinite(v); });
    }

    size_t block_index(const glm::ivec3& block) const {
        return (size_t(block.z) * blocks_.y + block.y) * blocks_.x + block.x;
    }

    // Whether the ray is inside is carried from cell to cell and over skipped blocks, so that
    // rounding on their faces loses no crossing.
    Crossing first_hit(const Ray& ray, std::pair<double, double> range, size_t surface) const {
        Crossing crossing;
        std::optional<bool> inside;
        walk(ray, range.first, range.second, BLOCK, glm::ivec3(0), blocks_ - 1,
             [&](const glm::ivec3& block, double enter, double leave) {
                 Block kind = kinds_[surface][block_index(block)];
                 if (kind == Block::crossed) {
                     crossing = hit_in_block(ray, block, enter, leave, isovalues_[surface], inside);
                 } else if (kind == Block::holed) {
                     inside.reset();
                 } else {
                     if (inside && *inside != (kind == Block::inside)) crossing = {enter, *inside};
                     inside = kind == Block::inside;
                 }
                 return crossing.depth != INFINITE;
             });
        return crossing;
    }

    Crossing hit_in_block(const Ray& ray, const glm::ivec3& block, double enter, double leave,
                          double isovalue, std::optional<bool>& inside) const {
        Crossing crossing;
        glm::ivec3 lowest = block * BLOCK, highest = glm::min(lowest + BLOCK, cells()) - 1;
        walk(ray, enter, leave, 1, lowest, highest,
             [&](const glm::ivec3& cell, double t0, double t1) {
                 auto corners = corners_of(cell);
                 if (!finite(corners)) {
                     inside.reset();
                     return false;
                 }
                 Cubic cubic = along(corners, ray.at(t0) - dvec3(cell), (t1 - t0) * ray.direction);
                 cubic[0] -= isovalue;
                 if (!inside) inside = cubic[0] >= 0;
                 if (auto u = first_crossing(cubic, *inside))
                     crossing = {t0 + *u * (t1 - t0), *inside};
                 return crossing.depth != INFINITE;
             });
        return crossing;
    }

    // The trilinear interpolant along start + u * way.
    static Cubic along(const std::array<double, 8>& corners, const dvec3& start, const dvec3& way) {
        Cubic sum{};
        for (int c = 0; c < 8; ++c) {
            Cubic product{corners[c], 0, 0, 0};
            for (int axis = 0; axis < 3; ++axis) {
                bool upper = (c >> axis & 1) != 0;
                double a = upper ? start[axis] : 1 - start[axis],
                       b = upper ? way[axis] : -way[axis];
                for (int power = 3; power > 0; --power)
                    product[power] = product[power] * a + product[power - 1] * b;
                product[0] *= a;
            }
            for (int power = 0; power < 4; ++power)
                sum[power] += product[power];
        }
        return sum;
    }

    std::vector<double> isovalues_, values_;
    std::vector<std::vector<Block>> kinds_;
    glm::ivec3 dims_, blocks_;
    glm::dmat3 linear_, inverse_;
    dvec3 origin_;
};

}  // namespace reference
