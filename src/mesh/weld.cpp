// SPDX-License-Identifier: MIT
// Edge collapse with the link condition (Dey, Edelsbrunner, Guha, Nekhayev 1999, "Topology
// preserving edge contraction"): an edge of a manifold may shrink to a vertex if its ends have no
// neighbours in common but the tips of its two triangles. Only edges between coincident vertices
// shrink, so nothing moves. At the border, a virtual vertex beyond it stands for the triangles that
// are missing.
#include "mesh/weld.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <span>

namespace isorast {

namespace {

constexpr uint32_t NONE = ~0u;

// The triangles around a vertex, and its neighbours with the number of triangles at each edge.
struct Star {
    std::vector<uint32_t> triangles;
    std::vector<std::pair<uint32_t, int>> neighbours;

    int triangles_with(uint32_t vertex) const {
        for (const auto& [neighbour, count] : neighbours)
            if (neighbour == vertex) return count;
        return 0;
    }
    void add_neighbour(uint32_t vertex) {
        for (auto& [neighbour, count] : neighbours)
            if (neighbour == vertex) {
                ++count;
                return;
            }
        neighbours.emplace_back(vertex, 1);
    }
    bool at_border() const {
        return std::ranges::any_of(neighbours, [](const auto& n) { return n.second == 1; });
    }
};

float step_of(glm::uvec3 voxels) {
    const uint32_t longest = std::max(std::max(voxels.x, voxels.y), voxels.z);
    return std::max(1.0f / 8192, 0x1p-23f * float(longest));
}

// The vertices at one corner of the grid: one for each crossed edge there, so at most six.
using Place = std::span<const uint32_t>;

class Welding {
public:
    Welding(Surface& surface, glm::uvec3 voxels);
    void run();

private:
    void find_places(glm::uvec3 voxels);
    void find_stars();
    glm::uvec3 corners(uint32_t triangle) const;
    Star star_of(uint32_t vertex, Place place) const;
    bool has_corner(uint32_t triangle, uint32_t vertex) const;
    bool has_triangle(const Star& star, uint32_t a, uint32_t b) const;
    bool join(uint32_t u, uint32_t v, Place place);
    bool join_any(Place place);
    std::vector<uint32_t> remaining(Place place) const;
    bool is_flat(uint32_t triangle) const;
    void drop_lines(Place place);
    void move_apart(Place place);
    void compact();

    Surface& surface_;
    const float step_;                          // of moving apart, voxels
    std::vector<uint32_t> shared_;              // vertices that share a place, place by place
    std::vector<Place> places_;                 // in shared_
    std::vector<uint32_t> place_of_;            // for each vertex, in places_; NONE
    std::vector<uint32_t> first_star_, stars_;  // the triangles of those vertices
    std::vector<uint32_t> joined_to_;           // for each vertex; itself at first
    std::vector<bool> gone_;                    // for each triangle
    std::vector<bool> has_area_;  // for each vertex: known to be of a part that has some
};

Welding::Welding(Surface& surface, glm::uvec3 voxels)
    : surface_(surface),
      step_(step_of(voxels)),
      place_of_(surface.positions.size(), NONE),
      joined_to_(surface.positions.size()),
      gone_(surface.triangles.size()),
      has_area_(surface.positions.size()) {
    std::iota(joined_to_.begin(), joined_to_.end(), 0);
    find_places(voxels);
    find_stars();
}

void Welding::find_places(glm::uvec3 voxels) {
    std::vector<std::pair<uint64_t, uint32_t>> at_corners;
    for (uint32_t vertex = 0; vertex < surface_.positions.size(); ++vertex) {
        const glm::vec3 p = surface_.positions[vertex];
        if (p != glm::floor(p)) continue;
        const glm::uvec3 c(p);
        at_corners.emplace_back(c.x + voxels.x * (c.y + uint64_t{voxels.y} * c.z), vertex);
    }
    std::ranges::sort(at_corners);
    shared_.reserve(at_corners.size());  // places_ point into it
    for (size_t i = 0, end = 0; i < at_corners.size(); i = end) {
        while (end < at_corners.size() && at_corners[end].first == at_corners[i].first)
            ++end;
        if (end - i < 2) continue;
        const size_t first = shared_.size();
        for (size_t k = i; k < end; ++k)
            shared_.push_back(at_corners[k].second);
        for (size_t k = first; k < shared_.size(); ++k)
            place_of_[shared_[k]] = uint32_t(places_.size());
        places_.emplace_back(shared_.data() + first, end - i);
    }
}

void Welding::find_stars() {
    first_star_.resize(surface_.positions.size() + 1);
    const auto for_each = [&](auto&& take) {
        for (uint32_t t = 0; t < surface_.triangles.size(); ++t)
            for (int i = 0; i < 3; ++i)
                if (const uint32_t vertex = surface_.triangles[t][i]; place_of_[vertex] != NONE)
                    take(t, vertex);
    };
    for_each([&](uint32_t, uint32_t vertex) { ++first_star_[vertex + 1]; });
    std::partial_sum(first_star_.begin(), first_star_.end(), first_star_.begin());
    stars_.resize(first_star_.back());
    std::vector<uint32_t> next(first_star_.begin(), first_star_.end() - 1);
    for_each([&](uint32_t t, uint32_t vertex) { stars_[next[vertex]++] = t; });
}

glm::uvec3 Welding::corners(uint32_t triangle) const {
    glm::uvec3 c = surface_.triangles[triangle];
    for (int i = 0; i < 3; ++i)
        while (joined_to_[c[i]] != c[i])
            c[i] = joined_to_[c[i]];
    return c;
}

Star Welding::star_of(uint32_t vertex, Place place) const {
    Star star;
    for (const uint32_t member : place) {
        uint32_t root = member;
        while (joined_to_[root] != root)
            root = joined_to_[root];
        if (root != vertex) continue;
        for (uint32_t i = first_star_[member]; i < first_star_[member + 1]; ++i) {
            if (gone_[stars_[i]]) continue;
            star.triangles.push_back(stars_[i]);
            const glm::uvec3 c = corners(stars_[i]);
            for (int corner = 0; corner < 3; ++corner)
                if (c[corner] != vertex) star.add_neighbour(c[corner]);
        }
    }
    return star;
}

bool Welding::has_corner(uint32_t triangle, uint32_t vertex) const {
    const glm::uvec3 c = corners(triangle);
    return c.x == vertex || c.y == vertex || c.z == vertex;
}

bool Welding::has_triangle(const Star& star, uint32_t a, uint32_t b) const {
    return std::ranges::any_of(star.triangles, [&](uint32_t triangle) {
        return has_corner(triangle, a) && has_corner(triangle, b);
    });
}

// Joins two vertices of a place; false if they must stay two.
bool Welding::join(uint32_t u, uint32_t v, Place place) {
    const Star a = star_of(u, place), b = star_of(v, place);
    if (a.triangles_with(v) == 0) return false;
    std::vector<uint32_t> common;
    for (const auto& [neighbour, count] : a.neighbours)
        if (b.triangles_with(neighbour) > 0) common.push_back(neighbour);
    // A border edge has one triangle, and one with the virtual vertex.
    const bool border = a.triangles_with(v) == 1;
    if (common.size() + (a.at_border() && b.at_border() ? 1 : 0) != 2) return false;

    // Two triangles back to back would be left of a tetrahedron, nothing of a lone triangle. As two
    // of their corners coincide, they hold no volume, and no area: if they are all there is, they
    // go.
    const bool alone =
        border ? a.triangles_with(common[0]) == 1 && b.triangles_with(common[0]) == 1
               : has_triangle(a, common[0], common[1]) && has_triangle(b, common[0], common[1]);
    const size_t whole = border ? 1 : 3;
    if (alone && (a.triangles.size() != whole || b.triangles.size() != whole)) return false;
    for (const uint32_t triangle : a.triangles)
        if (alone || has_corner(triangle, v)) gone_[triangle] = true;
    for (const uint32_t triangle : b.triangles)
        if (alone) gone_[triangle] = true;
    // A vertex at the border stays there when it is moved apart.
    if (b.at_border())
        joined_to_[u] = v;
    else
        joined_to_[v] = u;
    return true;
}

// The vertices that are left of a place.
std::vector<uint32_t> Welding::remaining(Place place) const {
    std::vector<uint32_t> vertices;
    for (const uint32_t vertex : place)
        if (joined_to_[vertex] == vertex && !star_of(vertex, place).triangles.empty())
            vertices.push_back(vertex);
    return vertices;
}

bool Welding::join_any(Place place) {
    bool joined = false;
    for (bool again = true; again;) {
        again = false;
        const auto vertices = remaining(place);
        for (size_t i = 0; i < vertices.size() && !again; ++i)
            for (size_t k = i + 1; k < vertices.size() && !again; ++k)
                again = join(vertices[i], vertices[k], place);
        joined = joined || again;
    }
    return joined;
}

// Two corners at one place.
bool Welding::is_flat(uint32_t triangle) const {
    const glm::uvec3 c = surface_.triangles[triangle];
    const auto& p = surface_.positions;
    return p[c.x] == p[c.y] || p[c.y] == p[c.z] || p[c.z] == p[c.x];
}

// Drops the part that a place belongs to if all its triangles are flat: a line of voxels, say.
void Welding::drop_lines(Place place) {
    std::vector<uint32_t> part;  // triangles
    std::vector<uint32_t> reached(place.begin(), place.end());
    std::set<uint32_t> known(place.begin(), place.end());
    bool has_area = false;
    for (size_t at = 0; at < reached.size() && !has_area; ++at)
        for (uint32_t i = first_star_[reached[at]]; i < first_star_[reached[at] + 1]; ++i) {
            const uint32_t triangle = stars_[i];
            if (gone_[triangle]) continue;
            part.push_back(triangle);
            has_area = has_area || !is_flat(triangle);
            for (int k = 0; k < 3; ++k) {
                const uint32_t other = surface_.triangles[triangle][k];
                has_area = has_area || place_of_[other] == NONE || has_area_[other];
                if (has_area) break;
                for (const uint32_t next : places_[place_of_[other]])
                    if (known.insert(next).second) reached.push_back(next);
            }
        }
    // What one place found out saves the others the search.
    for (const uint32_t vertex : reached)
        has_area_[vertex] = has_area;
    if (has_area) return;
    for (const uint32_t triangle : part)
        gone_[triangle] = true;
}

// Each along its own edge: no two have the same. Unlike distances, or two of them would be in line
// with a vertex across a cell's face, in a triangle without area. Large volumes want larger ones,
// as 32-bit floats have a step of their own.
void Welding::move_apart(Place place) {
    const auto vertices = remaining(place);
    if (vertices.size() < 2) return;
    for (const uint32_t vertex : vertices) {
        const int direction = int(surface_.gradients[vertex].w);
        const float distance = float(8 + direction) * step_;
        surface_.positions[vertex][direction % 3] += direction < 3 ? distance : -distance;
    }
}

void Welding::compact() {
    std::vector<uint32_t> numbers(surface_.positions.size(), NONE);
    std::vector<glm::uvec3> triangles;
    triangles.reserve(surface_.triangles.size());
    for (uint32_t t = 0; t < surface_.triangles.size(); ++t) {
        if (gone_[t]) continue;
        triangles.push_back(corners(t));
        for (int i = 0; i < 3; ++i)
            numbers[triangles.back()[i]] = 0;
    }
    uint32_t count = 0;
    for (uint32_t vertex = 0; vertex < numbers.size(); ++vertex) {
        if (numbers[vertex] == NONE) continue;
        surface_.positions[count] = surface_.positions[vertex];
        surface_.gradients[count] = surface_.gradients[vertex];
        numbers[vertex] = count++;
    }
    surface_.positions.resize(count);
    surface_.gradients.resize(count);
    for (glm::uvec3& triangle : triangles)
        for (int i = 0; i < 3; ++i)
            triangle[i] = numbers[triangle[i]];
    surface_.triangles = std::move(triangles);
}

void Welding::run() {
    // One place's vertices may be free to join only once a neighbour's have.
    std::vector<Place> open = places_;
    while (std::erase_if(open, [&](Place place) { return remaining(place).size() < 2; }),
           std::ranges::count_if(open, [&](Place place) { return join_any(place); }) > 0) {
    }
    for (const Place place : open)
        drop_lines(place);
    for (const Place place : open)
        move_apart(place);
    compact();
}

}  // namespace

void weld(Surface& surface, glm::uvec3 voxels) {
    Welding(surface, voxels).run();
    surface.blocks.clear();
}

}  // namespace isorast
