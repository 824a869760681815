// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/core/box.h"
#include "octavo/core/grid.h"
#include "octavo/mesh/scene.h"

/// What a change of a scene may reach, by boxes and balls: never less than it does. Common space,
/// but where the world is named.
namespace octavo {

/// 0 where they touch.
[[nodiscard]] double distance(const Box& a, const Box& b);

struct Ball {
    dvec3 middle{0.0};
    double radius = 0.0;
};

[[nodiscard]] Ball ball_of(const Box& box);

/// Whether a ball may touch a straight line from one ball to another.
[[nodiscard]] bool between(const Ball& ball, const Ball& from, const Ball& to);
/// The same where the lines go on for ever, in a cone of this half angle, in radians, about a
/// direction of unit length.
[[nodiscard]] bool between(const Ball& ball, const Ball& from, const dvec3& direction,
                           double angle);

/// The part of a hemisphere, by the cosine, that a ball covers at most, seen from in a box.
[[nodiscard]] double covered(const Box& from, const Ball& ball);

/// Whether a light may reach into a box. World space
[[nodiscard]] bool reaches(const Light& light, const Box& world_box);

/// Whether a ball may be between a light and a box. @param grid  of common space
[[nodiscard]] bool shades(const Ball& ball, const Light& light, const Box& box, const Grid& grid);

}  // namespace octavo
