// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "octavo/io/model.h"
#include "octavo/trace/dag_view.h"
#include "triangle_tracer.h"

namespace octavo::cli {

/// The same rays for voxels and for triangles.
struct RaySet {
    std::vector<shared::GridRay> voxel_rays;
    std::vector<TriangleRay> triangle_rays;

    [[nodiscard]] std::size_t size() const { return voxel_rays.size(); }
};

/// Points of a picture that light falls on, with the surface's unit normal; world space.
struct SurfacePoint {
    dvec3 position;
    dvec3 normal;
};

/// Pixels of a tile follow each other.
inline constexpr int kTilePixels = 8;  // along a side
inline constexpr std::size_t kTileRays = kTilePixels * std::size_t{kTilePixels};

/// One ray through the centre of each pixel, tile by tile.
[[nodiscard]] RaySet primary_rays(const Camera& camera, const Grid& grid, int size);

/// One ray towards the sun from each point that faces it.
[[nodiscard]] RaySet hard_shadow_rays(const std::vector<SurfacePoint>& points, const Grid& grid,
                                      const dvec3& to_sun);

/// `samples` rays towards the sun's disc from each such point.
[[nodiscard]] RaySet soft_shadow_rays(const std::vector<SurfacePoint>& points, const Grid& grid,
                                      const dvec3& to_sun, double radius, int samples);

/// `samples` rays by the cosine from each `stride`th point; their lengths make the falloff.
[[nodiscard]] RaySet ambient_rays(const std::vector<SurfacePoint>& points, const Grid& grid,
                                  double radius, int samples, int stride);

}  // namespace octavo::cli
