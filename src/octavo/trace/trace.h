// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "octavo/core/grid.h"
#include "octavo/dag/dag.h"

namespace octavo {

class Partitions;

/// The points origin + t * direction with t_min <= t < t_max. The direction has any length but
/// zero; t is in multiples of it. With NaN or infinity in origin or direction, or NaN in t, a ray
/// misses.
struct Ray {
    dvec3 origin{0.0};
    dvec3 direction{0.0, 0.0, 1.0};
    double t_min = 0.0;
    double t_max = std::numeric_limits<double>::infinity();
};

/// Through which face of its cell a ray came in. Low faces point towards the negative axis.
enum class Face : std::uint8_t {
    low_x,
    high_x,
    low_y,
    high_y,
    low_z,
    high_z,
    inside,  // the ray starts in the cell
    none,    // no hit
};

/// The cell where a ray ends: a voxel, unless the options let it end above.
struct Hit {
    double t = std::numeric_limits<double>::infinity();  // when the ray enters the cell; or t_min
    uvec3 path{0};  // the cell's integer coordinates at its level; at level depth, the voxel
    int level = 0;  // 0 is the root, depth the voxels
    Face face = Face::none;

    [[nodiscard]] explicit operator bool() const { return face != Face::none; }

    /// Outward normal of the face; zero for `inside` and `none`.
    [[nodiscard]] dvec3 normal() const;
};

/// Where a ray may end before it reaches a voxel.
struct TraceOptions {
    int level = kMaxDepth;  // at any cell of this level, which is then as good as full; 0 to 17
    double cone = 0.0;  // at any cell that subtends less than this, seen from the origin; radians
    Partitions* partitions = nullptr;  // of the DAG: for trace_any() of many rays that run alike,
                                       // as those to a lamp. The same results
};

/// The first voxel along a ray. Grid space: the same with a Grid of origin 0 and voxel size 1.
///
/// The voxel v is the cube [v, v + 1): a point on a plane between two voxels belongs to the one
/// that the ray goes into, and a ray that runs along the plane is in the upper one. A ray that
/// starts in a voxel hits it at t_min.
///
/// Precision: the ray is followed in float, from where it enters the grid; it may leave its line by
/// some 1e-7 of the distance. The hit's t is then taken in double from the plane of its face.
///
/// Cost: one node for each cell on the way that exists; nothing is allocated.
[[nodiscard]] Hit trace_closest(const Dag& dag, const Ray& grid_ray,
                                const TraceOptions& options = {}) noexcept;
[[nodiscard]] Hit trace_closest(const Dag& dag, const Grid& grid, const Ray& world_ray,
                                const TraceOptions& options = {}) noexcept;

/// Is there a voxel along the ray? The same as bool(trace_closest()), and cheaper.
[[nodiscard]] bool trace_any(const Dag& dag, const Ray& grid_ray,
                             const TraceOptions& options = {}) noexcept;
[[nodiscard]] bool trace_any(const Dag& dag, const Grid& grid, const Ray& world_ray,
                             const TraceOptions& options = {}) noexcept;

/// Many rays, on all threads of the calling arena (see core/parallel.h). Result i is that of ray i.
///
/// @param hits, occluded  as long as `rays`; occluded[i] is 0 or 1
void trace_closest(const Dag& dag, const Grid& grid, std::span<const Ray> rays, std::span<Hit> hits,
                   const TraceOptions& options = {}) noexcept;
void trace_any(const Dag& dag, const Grid& grid, std::span<const Ray> rays,
               std::span<std::uint8_t> occluded, const TraceOptions& options = {}) noexcept;

/// A ray from the face of a hit, in grid space. Its origin is exactly on the face, so it needs no
/// offset: it cannot meet the cell that it leaves. (In world space the rounding of the grid's
/// transform would move it off the face.)
///
/// @param grid_ray   the ray that made the hit, grid space
/// @param direction  grid space, any length; one that points into the face runs along it instead
[[nodiscard]] Ray leave_hit(const Dag& dag, const Ray& grid_ray, const Hit& hit,
                            const dvec3& direction) noexcept;

}  // namespace octavo
