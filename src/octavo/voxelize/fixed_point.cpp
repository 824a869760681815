// SPDX-License-Identifier: MIT
#include "octavo/voxelize/fixed_point.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace octavo {
namespace {

constexpr int kSceneBits = 24;       // across the scene, at least
constexpr int kMinFractionBits = 6;  // below a voxel, at least
constexpr std::size_t kGrain = 1 << 14;

bool is_finite(const dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// The region, in grid space, within which points are exact: one grid width around the grid.
struct Window {
    double low, high;
    explicit Window(const Grid& grid)
        : low(-static_cast<double>(grid.resolution())), high(2.0 * grid.resolution()) {}
    [[nodiscard]] bool contains(const dvec3& p) const {
        return std::min({p.x, p.y, p.z}) >= low && std::max({p.x, p.y, p.z}) <= high;
    }
};

/// Sutherland and Hodgman: keeps the part of a convex polygon on one side of an axis-aligned plane.
void clip_to_half_space(std::vector<dvec3>& polygon, int axis, double plane, double sign) {
    std::vector<dvec3> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const dvec3& a = polygon[i];
        const dvec3& b = polygon[(i + 1) % polygon.size()];
        const double from_a = sign * (a[axis] - plane);
        const double from_b = sign * (b[axis] - plane);
        if (from_a >= 0) kept.push_back(a);
        if ((from_a > 0 && from_b < 0) || (from_a < 0 && from_b > 0)) {
            dvec3 crossing = a + (b - a) * (from_a / (from_a - from_b));
            crossing[axis] = plane;
            kept.push_back(crossing);
        }
    }
    polygon = std::move(kept);
}

}  // namespace

FixedMesh::FixedMesh(const Scene& piece, const Grid& grid, const Box& bounds)
    : scene_triangles_(piece.triangles) {
    choose_precision(bounds, grid);
    round_points(piece, grid);
    count_and_clip(piece, grid);
}

void FixedMesh::choose_precision(const Box& bounds, const Grid& grid) {
    const Window window(grid);
    const dvec3 low = glm::clamp(grid.to_grid(bounds.low), dvec3(window.low), dvec3(window.high));
    const dvec3 high = glm::clamp(grid.to_grid(bounds.high), dvec3(window.low), dvec3(window.high));
    const dvec3 size = high - low;
    // The cube around a scene is exactly N wide but for rounding: do not let that halve the unit.
    const double extent = std::max({size.x, size.y, size.z}) * (1.0 + 1e-6);

    const int extent_bits = extent >= 1.0 ? std::ilogb(extent) : 0;
    frame_.fraction_bits = std::clamp(kSceneBits - extent_bits, kMinFractionBits, kSceneBits);
    frame_.base = ivec3(glm::floor(low));
}

FixedPoint FixedMesh::round(const dvec3& point_grid) const {
    const dvec3 scaled = (point_grid - dvec3(frame_.base)) * std::ldexp(1.0, frame_.fraction_bits);
    return {static_cast<std::int32_t>(std::lround(scaled.x)),
            static_cast<std::int32_t>(std::lround(scaled.y)),
            static_cast<std::int32_t>(std::lround(scaled.z)), kInside};
}

void FixedMesh::round_points(const Scene& scene, const Grid& grid) {
    const Window window(grid);
    points_.resize(scene.positions.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points_.size(), kGrain),
                      [&](const auto& r) {
                          for (std::size_t i = r.begin(); i < r.end(); ++i) {
                              const dvec3 p = grid.to_grid(scene.positions[i]);
                              if (!is_finite(scene.positions[i])) {
                                  points_[i] = {0, 0, 0, kNonFinite};
                              } else if (!window.contains(p)) {
                                  points_[i] = {0, 0, 0, kFar};
                              } else {
                                  points_[i] = round(p);
                              }
                          }
                      });
}

void FixedMesh::count_and_clip(const Scene& scene, const Grid& grid) {
    struct Found {
        std::uint64_t degenerate = 0;
        std::uint64_t non_finite = 0;
        std::vector<std::size_t> far;
    };
    const auto found = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, scene_triangles_.size(), kGrain), Found{},
        [&](const auto& r, Found f) {
            std::array<FixedPoint, 3> c;
            for (std::size_t i = r.begin(); i < r.end(); ++i) {
                if (corners(i, c)) {
                    f.degenerate += is_degenerate(c);
                } else if (((c[0].kind | c[1].kind | c[2].kind) & kNonFinite) != 0) {
                    f.non_finite += 1;
                } else {
                    f.far.push_back(i);
                }
            }
            return f;
        },
        [](Found a, const Found& b) {
            a.degenerate += b.degenerate;
            a.non_finite += b.non_finite;
            a.far.insert(a.far.end(), b.far.begin(), b.far.end());
            return a;
        });
    degenerate_ = found.degenerate;
    non_finite_ = found.non_finite;

    const Window window(grid);
    for (const std::size_t i : found.far) {
        const std::array<dvec3, 3> c = scene.corners(i);
        const dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
        degenerate_ += normal == dvec3(0.0);
        std::vector<dvec3> polygon = {grid.to_grid(c[0]), grid.to_grid(c[1]), grid.to_grid(c[2])};
        for (int axis = 0; axis < 3; ++axis) {
            clip_to_half_space(polygon, axis, window.low, 1.0);
            clip_to_half_space(polygon, axis, window.high, -1.0);
        }
        for (std::size_t k = 2; k < polygon.size(); ++k) {
            clipped_.push_back({round(polygon[0]), round(polygon[k - 1]), round(polygon[k])});
            clipped_from_.push_back(i);
        }
    }
}

bool is_degenerate(const std::array<FixedPoint, 3>& c) {
    const std::int64_t ux = c[1].x - c[0].x, uy = c[1].y - c[0].y, uz = c[1].z - c[0].z;
    const std::int64_t vx = c[2].x - c[0].x, vy = c[2].y - c[0].y, vz = c[2].z - c[0].z;
    return uy * vz == uz * vy && uz * vx == ux * vz && ux * vy == uy * vx;
}

}  // namespace octavo
