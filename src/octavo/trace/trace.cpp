// SPDX-License-Identifier: MIT
#include "octavo/trace/trace.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "octavo/trace/dag_view.h"
#include "octavo/trace/grid_ray.h"
#include "octavo/trace/wide.h"

namespace octavo {
namespace {

/// Rays that one task traces: some 100 us of work, much more than a task costs.
constexpr std::size_t kRaysPerTask = 256;

bool finite(const dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// A ray as the shared text wants it: near the grid, of length about one.
struct PreparedRay {
    shared::GridRay ray;
    shared::Stop stop;
    dvec3 direction;       // grid space, its largest component is in [0.5, 1)
    double t_moved = 0.0;  // by how much the origin was moved, in multiples of `direction`
    int exponent = 0;      // direction = given direction / 2^exponent
    bool meets_grid = false;
};

/// The ray's times in the grid's cube, grid space; empty where low > high.
void clip_to_grid(const dvec3& origin, const dvec3& direction, double side, double& low,
                  double& high) {
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0.0) {
            if (origin[axis] < 0.0 || origin[axis] > side) high = -HUGE_VAL;
            continue;
        }
        const double t0 = (0.0 - origin[axis]) / direction[axis];
        const double t1 = (side - origin[axis]) / direction[axis];
        low = std::max(low, std::min(t0, t1));
        high = std::min(high, std::max(t0, t1));
    }
}

PreparedRay prepare(const Dag& dag, const Ray& ray, const TraceOptions& options) {
    PreparedRay p;
    const dvec3 size = glm::abs(ray.direction);
    const double largest = std::max({size.x, size.y, size.z});
    if (dag.empty() || !finite(ray.origin) || !finite(ray.direction) || largest == 0.0 ||
        !(ray.t_min < ray.t_max))
        return p;

    // A power of two is exact, and takes denormal and huge directions into float's range.
    std::frexp(largest, &p.exponent);
    for (int axis = 0; axis < 3; ++axis)
        p.direction[axis] = std::ldexp(ray.direction[axis], -p.exponent);
    double t_min = std::ldexp(ray.t_min, p.exponent);
    double t_max = std::ldexp(ray.t_max, p.exponent);

    double low = t_min;
    double high = t_max;
    clip_to_grid(ray.origin, p.direction, dag.resolution(), low, high);
    if (!(low <= high) || !std::isfinite(low)) return p;

    // A far origin goes to just before the ray's first time in the grid: small numbers, and the
    // same precision wherever the ray came from. Two voxels before, so that rounding keeps it
    // outside.
    p.t_moved = std::abs(low) > 2.0 ? low - 2.0 : 0.0;
    const dvec3 origin = ray.origin + p.t_moved * p.direction;
    p.ray =
        grid_ray(origin, vec3(p.direction), static_cast<float>(std::min(t_max - p.t_moved, 1e30)));
    p.ray.t_min = static_cast<float>(t_min - p.t_moved);
    p.stop.height = std::clamp(dag.depth() - options.level, 0, dag.depth());
    p.stop.cone = static_cast<float>(options.cone * glm::length(p.direction));
    p.stop.time_before = static_cast<float>(p.t_moved);
    p.meets_grid = true;
    return p;
}

Hit to_hit(const Dag& dag, const Ray& ray, const PreparedRay& p, const shared::GridHit& found) {
    Hit hit;
    if (found.face == shared::kFaceNone) return hit;
    hit.path = found.path;
    hit.level = dag.depth() - found.height;
    hit.face = static_cast<Face>(found.face);
    if (hit.face == Face::inside) {
        hit.t = ray.t_min;
        return hit;
    }
    const int axis = found.face / 2;
    double t = p.t_moved + found.t;
    // Only a direction this steep makes the plane's time a better one than the float's.
    if (std::abs(p.direction[axis]) > 1e-15) {
        const double plane =
            std::ldexp(static_cast<double>(found.path[axis] + (found.face & 1u)), found.height);
        t = (plane - ray.origin[axis]) / p.direction[axis];
    }
    hit.t = std::max(ray.t_min, std::ldexp(t, -p.exponent));
    return hit;
}

Ray to_grid(const Grid& grid, const Ray& world) {
    return {grid.to_grid(world.origin), world.direction / grid.voxel_size, world.t_min,
            world.t_max};
}

/// Some rays of an array, as the vector walk wants them: those that miss the grid are left out.
struct PreparedRays {
    std::array<PreparedRay, kRaysPerTask> prepared;
    std::array<Ray, kRaysPerTask> grid_rays;
    std::array<shared::GridRay, kRaysPerTask> rays;
    std::array<std::size_t, kRaysPerTask> places;  // in the array that they came from
    std::size_t count = 0;

    void add(const Dag& dag, const Ray& ray, std::size_t place, const TraceOptions& options) {
        prepared[count] = prepare(dag, ray, options);
        if (!prepared[count].meets_grid) return;
        grid_rays[count] = ray;
        rays[count] = prepared[count].ray;
        places[count] = place;
        ++count;
    }
    [[nodiscard]] std::span<const shared::GridRay> all() const {
        return std::span(rays).first(count);
    }
};

/// Calls trace(first, count) for parts of an array, on all threads.
template <typename Trace>
void for_each_task(std::size_t count, const Trace& trace) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (count + kRaysPerTask - 1) / kRaysPerTask),
                      [&](const tbb::blocked_range<std::size_t>& tasks) {
                          for (std::size_t i = tasks.begin(); i != tasks.end(); ++i)
                              trace(i * kRaysPerTask,
                                    std::min(kRaysPerTask, count - i * kRaysPerTask));
                      });
}

}  // namespace

dvec3 Hit::normal() const {
    dvec3 normal(0.0);
    if (face < Face::inside) {
        const int number = static_cast<int>(face);
        normal[number / 2] = number % 2 == 1 ? 1.0 : -1.0;
    }
    return normal;
}

Hit trace_closest(const Dag& dag, const Ray& grid_ray, const TraceOptions& options) noexcept {
    const PreparedRay p = prepare(dag, grid_ray, options);
    if (!p.meets_grid) return {};
    return to_hit(dag, grid_ray, p, shared::trace_closest(shared::view(dag), p.ray, p.stop));
}

Hit trace_closest(const Dag& dag, const Grid& grid, const Ray& world_ray,
                  const TraceOptions& options) noexcept {
    return trace_closest(dag, to_grid(grid, world_ray), options);
}

bool trace_any(const Dag& dag, const Ray& grid_ray, const TraceOptions& options) noexcept {
    const PreparedRay p = prepare(dag, grid_ray, options);
    return p.meets_grid && shared::trace_any(shared::view(dag), p.ray, p.stop);
}

bool trace_any(const Dag& dag, const Grid& grid, const Ray& world_ray,
               const TraceOptions& options) noexcept {
    return trace_any(dag, to_grid(grid, world_ray), options);
}

// A cone is measured in multiples of each ray's own direction: then they go one by one.

void trace_closest(const Dag& dag, const Grid& grid, std::span<const Ray> rays, std::span<Hit> hits,
                   const TraceOptions& options) noexcept {
    for_each_task(rays.size(), [&](std::size_t first, std::size_t count) {
        if (options.cone != 0.0) {
            for (std::size_t i = first; i < first + count; ++i)
                hits[i] = trace_closest(dag, grid, rays[i], options);
            return;
        }
        PreparedRays some;
        std::array<shared::GridHit, kRaysPerTask> found;
        for (std::size_t i = 0; i < count; ++i) {
            hits[first + i] = {};
            some.add(dag, to_grid(grid, rays[first + i]), first + i, options);
        }
        if (some.count == 0) return;
        trace_closest_wide(dag, some.all(), {some.prepared[0].stop.height, 0.0f, 0.0f},
                           std::span(found).first(some.count));
        for (std::size_t i = 0; i < some.count; ++i)
            hits[some.places[i]] = to_hit(dag, some.grid_rays[i], some.prepared[i], found[i]);
    });
}

void trace_any(const Dag& dag, const Grid& grid, std::span<const Ray> rays,
               std::span<std::uint8_t> occluded, const TraceOptions& options) noexcept {
    for_each_task(rays.size(), [&](std::size_t first, std::size_t count) {
        if (options.cone != 0.0) {
            for (std::size_t i = first; i < first + count; ++i)
                occluded[i] = trace_any(dag, grid, rays[i], options);
            return;
        }
        PreparedRays some;
        std::array<std::uint8_t, kRaysPerTask> found;
        for (std::size_t i = 0; i < count; ++i) {
            occluded[first + i] = 0;
            some.add(dag, to_grid(grid, rays[first + i]), first + i, options);
        }
        if (some.count == 0) return;
        trace_any_wide(dag, some.all(), {some.prepared[0].stop.height, 0.0f, 0.0f},
                       std::span(found).first(some.count), options.partitions);
        for (std::size_t i = 0; i < some.count; ++i) occluded[some.places[i]] = found[i];
    });
}

Ray leave_hit(const Dag& dag, const Ray& grid_ray, const Hit& hit,
              const dvec3& direction) noexcept {
    const double width = std::ldexp(1.0, dag.depth() - hit.level);
    const dvec3 corner = dvec3(hit.path) * width;
    Ray next;
    next.origin = glm::clamp(grid_ray.origin + hit.t * grid_ray.direction, corner, corner + width);
    next.direction = direction;
    if (hit.face < Face::inside) {
        const int axis = static_cast<int>(hit.face) / 2;
        const bool high = static_cast<int>(hit.face) % 2 == 1;
        next.origin[axis] = corner[axis] + (high ? width : 0.0);
        // A zero counts as upwards, so on a low face it takes a negative number to stay outside.
        const double along =
            1e-15 * std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
        next.direction[axis] =
            high ? std::max(direction[axis], along) : std::min(direction[axis], -along);
    }
    return next;
}

}  // namespace octavo
