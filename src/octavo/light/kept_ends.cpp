// SPDX-License-Identifier: MIT
#include "octavo/light/kept_ends.h"

#include <algorithm>

#include "octavo/light/change_reach.h"

namespace octavo {
namespace {

double distance(const dvec3& point, const Box& box) {
    return octavo::distance(Box{point, point}, box);
}

}  // namespace

KeptEnds::KeptEnds(const MovedObject& moved, const CellWords& words)
    : moved_(moved),
      words_(words),
      first_word_(static_cast<std::uint32_t>(words.first_word(moved.object))),
      end_word_(static_cast<std::uint32_t>(words.end_word(moved.object))) {}

bool KeptEnds::begin(std::span<const std::uint32_t> row) {
    row_ = row;
    return std::any_of(row.begin(), row.end(),
                       [&](std::uint32_t word) { return end_by_word(word) == End::unknown; });
}

KeptEnds::End KeptEnds::end_by_word(std::uint32_t word) const {
    if (word == CellWords::kOpen) return End::open;
    if (word == CellWords::kNone || (word >= first_word_ && word < end_word_)) return End::unknown;
    return words_.shines(word) ? End::unknown : End::dark;
}

bool KeptEnds::out_of_sight(const dvec3& middle, double radius, const vec3& normal) const {
    const Ball ball = ball_of(moved_.after);
    return glm::dot(dvec3(normal), ball.middle - middle) < -(ball.radius + radius) &&
           distance(middle, moved_.before) > radius && distance(middle, moved_.after) > radius;
}

void KeptEnds::start(const dvec3& point, double reach) {
    near_ = distance(point, moved_.before) <= reach || distance(point, moved_.after) <= reach;
    const Ball ball = ball_of(moved_.after);
    low_ = vec3(moved_.after.low - point);
    high_ = vec3(moved_.after.high - point);
    centre_ = vec3(ball.middle - point);
    const auto radius = static_cast<float>(ball.radius);
    beyond_ = glm::dot(centre_, centre_) - radius * radius;
}

KeptEnds::End KeptEnds::end(std::uint32_t number, const vec3& direction) const {
    if (near_) return End::unknown;
    // First by the ball around the box, which most rays pass by.
    const float along = glm::dot(direction, centre_);
    if (beyond_ <= 0.0f ||
        (along > 0.0f && along * along >= beyond_ * glm::dot(direction, direction))) {
        float enter = 0.0f, leave = 1e30f;
        for (int axis = 0; axis < 3; ++axis) {
            const float inverse = 1.0f / direction[axis];
            const float a = low_[axis] * inverse, b = high_[axis] * inverse;
            // Where it is 0 over 0 the ray runs in a side of the box, which it may then meet.
            if (a != a || b != b) continue;
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        if (enter <= leave) return End::unknown;
    }
    return end_by_word(row_[number]);
}

}  // namespace octavo
