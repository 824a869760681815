// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octavo/core/vec.h"

namespace octavo {

/// Appends the triangles of a polygon: n - 2 of them, or none for fewer than three corners.
///
/// Convex polygons become a fan around the first corner, concave ones are cut ear by ear in the
/// plane of their area vector. Polygons that are not simple, or have more than 256 corners, may
/// come out as a fan: cutting takes time that grows with the cube of the corners.
///
/// @param corners  indices into positions, in range
void triangulate(std::span<const dvec3> positions, std::span<const std::uint32_t> corners,
                 std::vector<uvec3>& triangles);

}  // namespace octavo
