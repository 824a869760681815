// SPDX-License-Identifier: MIT
#include "octavo/mesh/triangulate.h"

#include <cmath>
#include <cstddef>

namespace octavo {
namespace {

constexpr std::size_t kMaxCutCorners = 256;

using Point = glm::dvec2;

/// Twice the signed area of a triangle in the plane.
double area(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
}

bool inside(const Point& p, const Point& a, const Point& b, const Point& c) {
    return area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0;
}

void fan(std::span<const std::uint32_t> corners, std::vector<uvec3>& triangles) {
    for (std::size_t i = 2; i < corners.size(); ++i)
        triangles.emplace_back(corners[0], corners[i - 1], corners[i]);
}

/// The polygon seen from the side of its area vector, so that it turns left; relative to its first
/// corner, so that far coordinates keep their detail.
std::vector<Point> flattened(std::span<const dvec3> positions,
                             std::span<const std::uint32_t> corners) {
    const dvec3 origin = positions[corners[0]];
    dvec3 normal{0.0};
    for (std::size_t i = 2; i < corners.size(); ++i)
        normal += glm::cross(positions[corners[i - 1]] - origin, positions[corners[i]] - origin);

    const dvec3 size = glm::abs(normal);
    const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double sign = normal[axis] < 0.0 ? -1.0 : 1.0;

    std::vector<Point> points;
    points.reserve(corners.size());
    for (const std::uint32_t corner : corners) {
        const dvec3 p = positions[corner] - origin;
        points.emplace_back(sign * p[u], p[v]);
    }
    return points;
}

bool is_convex(const std::vector<Point>& points) {
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i)
        if (!(area(points[i], points[(i + 1) % n], points[(i + 2) % n]) >= 0.0)) return false;
    return true;
}

/// An ear is a corner that turns left and whose triangle holds no other corner.
bool is_ear(const std::vector<Point>& points, const std::vector<std::uint32_t>& ring,
            std::size_t i) {
    const std::size_t n = ring.size();
    const std::uint32_t before = ring[(i + n - 1) % n], here = ring[i], after = ring[(i + 1) % n];
    const Point &a = points[before], &b = points[here], &c = points[after];
    if (!(area(a, b, c) > 0.0)) return false;
    for (const std::uint32_t other : ring) {
        if (other == before || other == here || other == after) continue;
        const Point& p = points[other];
        // A corner that touches another one of the ring (a hole's bridge) does not block the ear.
        if (p == a || p == b || p == c) continue;
        if (inside(p, a, b, c)) return false;
    }
    return true;
}

}  // namespace

void triangulate(std::span<const dvec3> positions, std::span<const std::uint32_t> corners,
                 std::vector<uvec3>& triangles) {
    if (corners.size() <= 3 || corners.size() > kMaxCutCorners) return fan(corners, triangles);
    const std::vector<Point> points = flattened(positions, corners);
    if (is_convex(points)) return fan(corners, triangles);

    std::vector<std::uint32_t> ring(corners.size());
    for (std::uint32_t i = 0; i < ring.size(); ++i) ring[i] = i;
    while (ring.size() > 3) {
        std::size_t ear = 0;
        while (ear < ring.size() && !is_ear(points, ring, ear)) ++ear;
        // None is left where the outline crosses itself; any corner will do then.
        if (ear == ring.size()) ear = 1;
        const std::size_t n = ring.size();
        triangles.emplace_back(corners[ring[(ear + n - 1) % n]], corners[ring[ear]],
                               corners[ring[(ear + 1) % n]]);
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    triangles.emplace_back(corners[ring[0]], corners[ring[1]], corners[ring[2]]);
}

}  // namespace octavo
