// SPDX-License-Identifier: MIT
// How well one picture agrees with another: silhouettes, depths, normals, holes.
#pragma once
#include <algorithm>
#include <cmath>

#include "reference/picture.h"

namespace reference {

struct Agreement {
    double overlap = 1;         // of the silhouettes: intersection over union
    double depth_rms = 0;       // world units, over pixels that both hit, inner silhouettes aside
    double normal_degrees = 0;  // mean angle over the same pixels
    uint64_t covered = 0;       // pixels that the truth hits
    uint64_t measured = 0;      // pixels that entered depth_rms and normal_degrees
    uint64_t holes = 0;  // pixels not hit though the truth hits all around them and leaves no gap
};

inline bool covers(const Picture& picture, uint32_t x, uint32_t y) {
    return picture.at(x, y).depth != INFINITE;
}

// True when the truth hits this pixel and its eight neighbours.
inline bool deep_inside(const Picture& truth, uint32_t x, uint32_t y) {
    if (x == 0 || y == 0 || x + 1 >= truth.size.width || y + 1 >= truth.size.height) return false;
    for (uint32_t v = y - 1; v <= y + 1; ++v)
        for (uint32_t u = x - 1; u <= x + 1; ++u)
            if (!covers(truth, u, v)) return false;
    return true;
}

// True when no neighbour's depth is further away than `jump`: else half a pixel decides between two
// surfaces.
inline bool smooth(const Picture& truth, uint32_t x, uint32_t y, double jump) {
    if (!deep_inside(truth, x, y)) return false;
    for (uint32_t v = y - 1; v <= y + 1; ++v)
        for (uint32_t u = x - 1; u <= x + 1; ++u)
            if (std::abs(truth.at(u, v).depth - truth.at(x, y).depth) > jump) return false;
    return true;
}

inline Agreement agreement(const Picture& picture, const Picture& truth, double jump) {
    Agreement result;
    uint64_t both = 0, either = 0;
    double squares = 0, angles = 0;
    for (uint32_t y = 0; y < truth.size.height; ++y) {
        for (uint32_t x = 0; x < truth.size.width; ++x) {
            bool hit = covers(picture, x, y), expected = covers(truth, x, y);
            both += hit && expected;
            either += hit || expected;
            result.covered += expected;
            if (!hit && deep_inside(truth, x, y)) result.holes += !truth.solid || truth.solid(x, y);
            if (!hit || !smooth(truth, x, y, jump)) continue;
            const Hit &a = picture.at(x, y), &b = truth.at(x, y);
            squares += (a.depth - b.depth) * (a.depth - b.depth);
            angles += glm::degrees(std::acos(std::clamp(glm::dot(a.normal, b.normal), -1.0, 1.0)));
            ++result.measured;
        }
    }
    if (either > 0) result.overlap = double(both) / double(either);
    if (result.measured > 0) {
        result.depth_rms = std::sqrt(squares / double(result.measured));
        result.normal_degrees = angles / double(result.measured);
    }
    return result;
}

}  // namespace reference
