// SPDX-License-Identifier: MIT
#include "bench_differences.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "octavo/core/box.h"
#include "octavo/render/effects.h"

namespace octavo::cli {
namespace {

/// For what float leaves open; voxels.
constexpr double kSlack = 0.01;
constexpr std::uint32_t kRaysIntoVoxel = 64;

bool meets_plane(const dvec3& centre, const TriangleRay& ray, const TriangleHit& hit,
                 const Grid& grid) {
    const dvec3 normal = glm::normalize(dvec3(hit.normal));
    const dvec3 point = dvec3(ray.origin) + double(hit.t) * dvec3(ray.direction);
    const double reach = 0.5 * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
    return std::abs(glm::dot(normal, grid.to_grid(point) - centre)) <= reach + kSlack;
}

bool sees_triangle_in(const dvec3& corner, const TriangleRay& ray, const TriangleTracer& triangles,
                      const Grid& grid, std::uint32_t seed) {
    std::array<TriangleRay, kRaysIntoVoxel> rays;
    std::array<TriangleHit, kRaysIntoVoxel> hits;
    for (std::uint32_t i = 0; i < kRaysIntoVoxel; ++i) {
        const dvec3 place(shared::sample_2d(i, seed), shared::sample_1d(i, ~seed));
        const dvec3 way = grid.to_world(corner + place) - dvec3(ray.origin);
        rays[i] = {ray.origin, ray.t_max, vec3(way)};
    }
    triangles.closest(rays, TriangleTracer::Width::sixteen, true, hits);
    for (std::uint32_t i = 0; i < kRaysIntoVoxel; ++i) {
        if (!std::isfinite(hits[i].t)) continue;
        const dvec3 at =
            grid.to_grid(dvec3(rays[i].origin) + double(hits[i].t) * dvec3(rays[i].direction)) -
            corner;
        if (std::min({at.x, at.y, at.z}) >= -kSlack && std::max({at.x, at.y, at.z}) <= 1.0 + kSlack)
            return true;
    }
    return false;
}

}  // namespace

bool agrees(const shared::GridRay& ray, const shared::GridHit& hit, const TriangleHit& triangle) {
    const bool met = hit.face != shared::kFaceNone;
    return met == std::isfinite(triangle.t) &&
           (!met || std::abs(hit.t - triangle.t) * glm::length(ray.dir) < kAgreeVoxels);
}

void count_differences(const RaySet& set, const Grid& grid, const TriangleTracer& triangles,
                       std::span<const shared::GridHit> hits, std::span<const TriangleHit> found,
                       Differences& sum) {
    sum.rays += set.size();
    for (std::size_t i = 0; i < set.size(); ++i) {
        const TriangleRay& ray = set.triangle_rays[i];
        const dvec3 corner(hits[i].path);
        if (agrees(set.voxel_rays[i], hits[i], found[i]))
            ++sum.agree;
        else if (hits[i].face == shared::kFaceNone || hits[i].t > found[i].t)
            ++sum.later;
        else if (std::isfinite(found[i].t) && meets_plane(corner + 0.5, ray, found[i], grid))
            ++sum.plane;
        else if (sees_triangle_in(corner, ray, triangles, grid,
                                  shared::mix_bits(static_cast<std::uint32_t>(i))))
            ++sum.beside;
        else
            ++sum.other;
    }
}

}  // namespace octavo::cli
