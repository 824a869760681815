// SPDX-License-Identifier: MIT
#include "octavo/light/change_reach.h"

#include <algorithm>
#include <cmath>

#include "octavo/light/light_grid.h"

namespace octavo {
namespace {

/// What a lamp that is in a place fills of the world; empty for a sun.
Box lamp_box(const Light& light) {
    Box box;
    if (light.kind == Light::Kind::sun) return box;
    if (light.kind != Light::Kind::mesh) box.extend(light.position);
    for (const auto& triangle : light.triangles)
        for (const dvec3& corner : triangle) box.extend(corner);
    return box;
}

}  // namespace

double distance(const Box& a, const Box& b) {
    return glm::length(glm::max(dvec3(0.0), glm::max(a.low - b.high, b.low - a.high)));
}

Ball ball_of(const Box& box) {
    return {box.centre(), 0.5 * glm::length(box.size())};
}

bool between(const Ball& ball, const Ball& from, const Ball& to) {
    const dvec3 way = to.middle - from.middle;
    const double length2 = glm::dot(way, way);
    const double along =
        length2 > 0.0 ? std::clamp(glm::dot(ball.middle - from.middle, way) / length2, 0.0, 1.0)
                      : 0.0;
    return glm::length(ball.middle - (from.middle + along * way)) <=
           ball.radius + std::max(from.radius, to.radius);
}

bool between(const Ball& ball, const Ball& from, const dvec3& direction, double angle) {
    const dvec3 way = ball.middle - from.middle;
    const double along = glm::dot(way, direction);
    const double reach = ball.radius + from.radius;
    if (along < -reach) return false;
    const double across = glm::length(way - along * direction);
    return across <= reach + (std::max(along, 0.0) + reach) * std::tan(std::min(angle, 1.5));
}

double covered(const Box& from, const Ball& ball) {
    const dvec3 nearest = glm::clamp(ball.middle, from.low, from.high);
    const double way = glm::length(nearest - ball.middle);
    return way <= ball.radius ? 1.0 : ball.radius * ball.radius / (way * way);
}

bool reaches(const Light& light, const Box& world_box) {
    const double reach = light_reach(light, LightGrid::kLeast);
    if (!std::isfinite(reach)) return true;
    const Box lamp = lamp_box(light);
    return !lamp.empty() && distance(lamp, world_box) <= reach;
}

bool shades(const Ball& ball, const Light& light, const Box& box, const Grid& grid) {
    if (light.kind == Light::Kind::sun)
        return between(ball, ball_of(box), -light.direction, light.size);
    if (!reaches(light, {grid.to_world(box.low), grid.to_world(box.high)})) return false;
    const Box lamp = lamp_box(light);
    const double size = light.size + glm::length(light.half_u) + glm::length(light.half_v);
    return between(ball, ball_of(box),
                   Ball{grid.to_grid(lamp.centre()),
                        (size + 0.5 * glm::length(lamp.size())) / grid.voxel_size});
}

}  // namespace octavo
