// SPDX-License-Identifier: MIT
#include "octavo/attributes/nearest_triangle.h"

#include <algorithm>

namespace octavo {
namespace {

/// The point of a triangle that is nearest to p. Ericson, "Real-Time Collision Detection", 5.1.5.
dvec3 nearest_point(const std::array<dvec3, 3>& t, const dvec3& p) {
    const dvec3 ab = t[1] - t[0], ac = t[2] - t[0];
    const auto on_segment = [&](const dvec3& a, const dvec3& b) {
        const double square = glm::dot(b - a, b - a);
        if (square == 0.0) return a;
        return a + std::clamp(glm::dot(p - a, b - a) / square, 0.0, 1.0) * (b - a);
    };
    const dvec3 normal = glm::cross(ab, ac);
    const double square = glm::dot(normal, normal);
    if (square > 0.0) {
        const double b = glm::dot(glm::cross(p - t[0], ac), normal) / square;
        const double c = glm::dot(glm::cross(ab, p - t[0]), normal) / square;
        if (b >= 0.0 && c >= 0.0 && b + c <= 1.0) return t[0] + b * ab + c * ac;
    }
    dvec3 best = t[0];
    double least = std::numeric_limits<double>::infinity();
    for (unsigned i = 0; i < 3; ++i) {
        const dvec3 q = on_segment(t[i], t[(i + 1) % 3]);
        const double distance = glm::dot(q - p, q - p);
        if (distance < least) {
            least = distance;
            best = q;
        }
    }
    return best;
}

bool before(const std::array<dvec3, 3>& a, const std::array<dvec3, 3>& b) {
    for (unsigned i = 0; i < 3; ++i)
        for (int axis = 0; axis < 3; ++axis)
            if (a[i][axis] != b[i][axis]) return a[i][axis] < b[i][axis];
    return false;
}

}  // namespace

void NearestTriangle::offer(const dvec3& to, const std::array<dvec3, 3>& triangle,
                            std::size_t number) {
    const dvec3 nearest = nearest_point(triangle, to);
    const double squared = glm::dot(nearest - to, nearest - to);
    if (squared < squared_distance ||
        (squared == squared_distance && found() && before(triangle, corners)))
        *this = {squared, triangle, number, nearest};
}

}  // namespace octavo
