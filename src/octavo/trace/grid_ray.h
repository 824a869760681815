// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/core/vec.h"
#include "octavo/trace/dag_view.h"

namespace octavo {

/// A point and a direction as the shared text takes a ray: from cell + fraction, at t_min 0. The
/// point keeps its place to a float's fraction of a voxel, however far from the grid's corner it
/// is.
///
/// @param point  grid space, below 2^29
[[nodiscard]] inline shared::GridRay grid_ray(const dvec3& point, const vec3& direction,
                                              float t_max) {
    const dvec3 cell = glm::floor(point);
    return {ivec3(cell), vec3(point - cell), direction, 0.0f, t_max};
}

/// The point that it starts from.
[[nodiscard]] inline dvec3 origin_of(const shared::GridRay& ray) {
    return dvec3(ray.cell) + dvec3(ray.frac);
}

}  // namespace octavo
