// SPDX-License-Identifier: MIT
#include "bench_rays.h"

#include <cmath>
#include <numbers>

#include "octavo/render/effects.h"
#include "octavo/render/pixel_rays.h"
#include "octavo/trace/grid_ray.h"

namespace octavo::cli {
namespace {

/// Secondary rays start this many voxels before the surface: voxels of the conservative rule reach
/// up to the square root of 3 of their side beyond their triangle.
constexpr double kLift = 2.5;

/// Adds a ray in world space, of unit direction and with t_max in world units.
void add(RaySet& set, const Grid& grid, const dvec3& origin, const vec3& direction, float t_max) {
    const vec3 start(origin);  // both trace from the same point
    const dvec3 grid_origin = grid.to_grid(dvec3(start));
    set.triangle_rays.push_back({start, t_max, direction});
    set.voxel_rays.push_back(
        grid_ray(grid_origin, direction, static_cast<float>(t_max / grid.voxel_size)));
}

dvec3 lifted(const SurfacePoint& point, const Grid& grid) {
    return point.position + kLift * grid.voxel_size * point.normal;
}

}  // namespace

RaySet primary_rays(const Camera& camera, const Grid& grid, int size) {
    const PixelRays rays(camera, grid, size, size);
    RaySet set;
    for (int y0 = 0; y0 < size; y0 += kTilePixels)
        for (int x0 = 0; x0 < size; x0 += kTilePixels)
            for (int i = 0; i < kTilePixels * kTilePixels; ++i) {
                set.voxel_rays.push_back(rays.ray(x0 + i % kTilePixels, y0 + i / kTilePixels));
                // Of the same length as a voxel's ray, so that times are comparable.
                const dvec3 direction = dvec3(set.voxel_rays.back().dir) * grid.voxel_size;
                const dvec3 origin = camera.eye + double(rays.t_before()) * direction;
                set.triangle_rays.push_back({vec3(origin), 1e30f, vec3(direction)});
            }
    return set;
}

RaySet hard_shadow_rays(const std::vector<SurfacePoint>& points, const Grid& grid,
                        const dvec3& to_sun) {
    RaySet set;
    for (const SurfacePoint& point : points)
        if (glm::dot(point.normal, to_sun) > 0.0)
            add(set, grid, lifted(point, grid), vec3(to_sun), 1e30f);
    return set;
}

RaySet soft_shadow_rays(const std::vector<SurfacePoint>& points, const Grid& grid,
                        const dvec3& to_sun, double radius, int samples) {
    RaySet set;
    std::uint32_t seed = 1;
    for (const SurfacePoint& point : points) {
        seed = shared::mix_bits(seed + 1);
        if (!(glm::dot(point.normal, to_sun) > 0.0)) continue;
        for (int i = 0; i < samples; ++i) {
            const vec2 disc =
                static_cast<float>(radius) *
                shared::disc_point(shared::sample_2d(static_cast<std::uint32_t>(i), seed));
            const vec3 direction =
                vec3(to_sun) + shared::from_frame(vec3(to_sun), vec3(disc, 0.0f));
            add(set, grid, lifted(point, grid), glm::normalize(direction), 1e30f);
        }
    }
    return set;
}

RaySet ambient_rays(const std::vector<SurfacePoint>& points, const Grid& grid, double radius,
                    int samples, int stride) {
    RaySet set;
    std::uint32_t seed = 2;
    for (std::size_t k = 0; k < points.size(); k += static_cast<std::size_t>(stride)) {
        const SurfacePoint& point = points[k];
        seed = shared::mix_bits(seed + 1);
        for (int i = 0; i < samples; ++i) {
            const auto number = static_cast<std::uint32_t>(i);
            const vec3 direction =
                shared::cosine_direction(vec3(point.normal), shared::sample_2d(number, seed));
            const float length = static_cast<float>(radius) * shared::sample_1d(number, ~seed);
            add(set, grid, lifted(point, grid), direction, length);
        }
    }
    return set;
}

}  // namespace octavo::cli
