// SPDX-License-Identifier: MIT
#pragma once

#include <limits>

#include "octavo/core/vec.h"

namespace octavo {

/// A closed axis-aligned box in world space. Default-constructed it is empty: it holds no point,
/// and extending it by a point gives that point.
struct Box {
    dvec3 low{std::numeric_limits<double>::infinity()};
    dvec3 high{-std::numeric_limits<double>::infinity()};

    [[nodiscard]] bool empty() const {
        return !(low.x <= high.x && low.y <= high.y && low.z <= high.z);
    }
    [[nodiscard]] dvec3 size() const { return high - low; }
    [[nodiscard]] dvec3 centre() const { return 0.5 * (low + high); }

    void extend(const dvec3& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    void extend(const Box& other) {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
};

}  // namespace octavo
