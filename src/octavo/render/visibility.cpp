// SPDX-License-Identifier: MIT
#include "octavo/render/visibility.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "octavo/core/error.h"
#include "octavo/light/lamp.h"
#include "octavo/render/effects.h"
#include "octavo/render/settings.h"
#include "octavo/trace/grid_ray.h"
#include "octavo/trace/partitions.h"
#include "octavo/trace/ray_queue.h"

namespace octavo {
namespace {

/// Points that one task takes: with 64 rays each, a hundred times a task's cost.
constexpr std::size_t kPointsPerTask = 64;

/// Above the voxels' exact reach, for the rounding of positions and normals to float.
constexpr double kSlack = 1e-3;

/// Farther than this from the grid a cell's number might leave 32 bits.
constexpr double kFarthest = 1 << 29;

}  // namespace

void check(const VisibilityOptions& o, std::size_t points, std::size_t normals, std::size_t shadow,
           std::size_t ambient) {
    const auto refuse = [](const char* what) { throw Error(Errc::bad_argument, what); };
    if (normals != points || (shadow != 0 && shadow != points) ||
        (ambient != 0 && ambient != points))
        refuse("visibility: the arrays differ in length");
    if (o.shadow_samples < 1 || o.shadow_samples > 65536 || o.ao_samples < 0 ||
        o.ao_samples > 65536)
        refuse("visibility: samples are 1 to 65536");
    if (o.light && !(o.light->size >= 0.0 && std::isfinite(o.light->size)))
        refuse("visibility: the light's size is negative or not finite");
    if (!(o.ao_cone >= 0.0) || !std::isfinite(o.ao_cone))
        refuse("visibility: the ambient cone is negative or not finite");
    if (!(o.bias >= 0.0) || !std::isfinite(o.bias))
        refuse("visibility: the bias is negative or not finite");
    if (ambient != 0 && o.ao_samples > 0 && !(o.ao_radius > 0.0 && std::isfinite(o.ao_radius)))
        refuse("visibility: the ambient radius is not a number above 0");
}

double visibility_bias(const dvec3& normal) {
    return std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
}

std::optional<shared::GridRay> lifted_start(const Grid& grid, const dvec3& position,
                                            const vec3& normal, double bias) {
    const double length = glm::length(dvec3(normal));
    if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
    const double lift = bias * (visibility_bias(dvec3(normal) / length) + kSlack);
    const dvec3 origin = grid.to_grid(position) + lift * dvec3(normal) / length;
    for (int axis = 0; axis < 3; ++axis)
        if (!(std::abs(origin[axis]) < kFarthest)) return std::nullopt;
    return grid_ray(origin, normal, 1e30f);
}

void visibility(const Dag& dag, const Grid& grid, std::span<const dvec3> positions,
                std::span<const vec3> normals, const VisibilityOptions& options,
                std::span<float> shadow, std::span<float> ambient) {
    check(options, positions.size(), normals.size(), shadow.size(), ambient.size());
    const bool shadows = options.light && !shadow.empty();
    const bool sky = options.ao_samples > 0 && !ambient.empty();
    const float radius = static_cast<float>(options.ao_radius / grid.voxel_size);
    std::optional<Partitions> own;
    if (shadows && options.partitions == nullptr) own.emplace(dag);
    Partitions* const partitions = own ? &*own : options.partitions;
    const Lamp light(options.light.value_or(Light{}), grid);

    const auto trace_some = [&](std::size_t first, std::size_t end) {
        RayQueue sky_queue(dag, {0, static_cast<float>(options.ao_cone), 0.0f});
        RayQueue lamp_queue(dag, shared::stop_at_voxels(), partitions);
        std::vector<float> all_light(end - first, 0.0f);  // that comes where nothing is in the way
        for (std::size_t i = first; i < end; ++i) {
            sky_queue.begin_group();
            lamp_queue.begin_group();
            const auto start = lifted_start(grid, positions[i], normals[i], options.bias);
            if (!start) {
                sky_queue.add_seen(static_cast<float>(options.ao_samples));
                lamp_queue.add_seen(all_light[i - first] = 1.0f);
                continue;
            }
            const vec3 normal = glm::normalize(normals[i]);
            const auto number = static_cast<std::uint32_t>(i);
            const std::uint32_t seed =
                shared::pixel_seed(number, static_cast<std::uint32_t>(i >> 32), options.frame);
            if (sky)
                for (int n = 0; n < options.ao_samples; ++n)
                    sky_queue.add(sky_ray(*start, shared::kFaceNone, normal, radius, n,
                                          shared::hemisphere_seed(seed)));
            if (shadows)
                all_light[i - first] =
                    queue_lamp_rays({light, *start, shared::kFaceNone, normal, false}, 0,
                                    options.shadow_samples, shared::lamp_seed(seed, 0), lamp_queue);
        }
        sky_queue.trace();
        lamp_queue.trace();
        for (std::size_t i = first; i < end; ++i) {
            if (sky)
                ambient[i] = sky_queue.seen(i - first) / static_cast<float>(options.ao_samples);
            const float all = all_light[i - first];
            if (shadows) shadow[i] = all > 0.0f ? lamp_queue.seen(i - first) / all : 0.0f;
        }
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(
                          0, (positions.size() + kPointsPerTask - 1) / kPointsPerTask),
                      [&](const tbb::blocked_range<std::size_t>& tasks) {
                          for (std::size_t task = tasks.begin(); task != tasks.end(); ++task)
                              trace_some(task * kPointsPerTask,
                                         std::min(positions.size(), (task + 1) * kPointsPerTask));
                      });
}

}  // namespace octavo
