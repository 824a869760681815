// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "bench_rays.h"
#include "octavo/core/grid.h"
#include "triangle_tracer.h"

namespace octavo::cli {

/// Why closest hits on voxels and on triangles differ. Each ray is counted once, under the first
/// that holds.
struct Differences {
    std::size_t rays = 0;
    std::size_t agree = 0;   // both miss, or both hit within kAgreeVoxels along the ray
    std::size_t later = 0;   // the triangle comes first, or alone: a hole of the voxels
    std::size_t plane = 0;   // the voxel meets the plane of the triangle that is hit: grazing
    std::size_t beside = 0;  // one of 64 rays from the same origin to points of the voxel meets a
                             // triangle in it: a silhouette
    std::size_t other = 0;
};

/// Voxels along a ray.
inline constexpr float kAgreeVoxels = 4.0f;

[[nodiscard]] bool agrees(const shared::GridRay& ray, const shared::GridHit& hit,
                          const TriangleHit& triangle);

/// Counts the rays of a set into `sum`. @param hits, found  of its rays; hits are voxels
void count_differences(const RaySet& set, const Grid& grid, const TriangleTracer& triangles,
                       std::span<const shared::GridHit> hits, std::span<const TriangleHit> found,
                       Differences& sum);

}  // namespace octavo::cli
