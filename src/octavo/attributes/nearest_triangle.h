// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "octavo/core/vec.h"

namespace octavo {

/// The triangle nearest to a point, of those that were offered. Of equally near ones it is the one
/// that has the lesser corners, whatever their order.
struct NearestTriangle {
    double squared_distance = std::numeric_limits<double>::infinity();
    std::array<dvec3, 3> corners{};
    std::size_t in_scene = 0;
    dvec3 point{0.0};  // of the triangle, the nearest one

    [[nodiscard]] bool found() const {
        return squared_distance < std::numeric_limits<double>::infinity();
    }
    /// @param to  the same point each time
    void offer(const dvec3& to, const std::array<dvec3, 3>& triangle, std::size_t number);
};

}  // namespace octavo
