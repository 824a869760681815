// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "octavo/core/grid.h"
#include "octavo/core/progress.h"
#include "octavo/dag/dag.h"
#include "octavo/mesh/scene.h"
#include "octavo/trace/dag_view.h"

namespace octavo {

class Partitions;

/// What visibility() asks for.
struct VisibilityOptions {
    std::optional<Light> light = {};  // none: the shadow array is not written
    int shadow_samples = 1;  // rays for each point; 1 is enough where the light has no size

    int ao_samples = 64;     // 0: the ambient array is not written
    double ao_radius = 0.0;  // world units, above 0: beyond it nothing occludes
    double ao_cone = 0.0;    // radians: a ray may stop at cells that look smaller; 0: never

    double bias = 1.0;        // of visibility_bias()
    std::uint32_t frame = 0;  // another number gives other noise

    Partitions* partitions = nullptr;  // of the DAG, kept for the next call; none: made for this
};

/// How far above a triangle, in voxels, no voxel of it reaches: |x| + |y| + |z| of its unit normal.
/// (A conservative voxel touches its triangle, and this is a unit cube's width along the normal.)
/// A point lifted by it sees neither acne, since rays of the normal's hemisphere lead away from the
/// plane, nor gaps wider than 1.74 voxels where things touch.
[[nodiscard]] double visibility_bias(const dvec3& normal);

/// A point of a triangle as the start of rays, `bias` times visibility_bias(normal) above it: in
/// grid space, of direction `normal`, without an end; none where a number is not finite, the normal
/// is zero or the grid is too far away.
[[nodiscard]] std::optional<shared::GridRay> lifted_start(const Grid& grid, const dvec3& position,
                                                          const vec3& normal, double bias);

/// Shadow and ambient occlusion for points of surfaces that somebody else found: the pixels of a
/// rasterised picture, the texels of a light map ([K13] section 4: secondary rays for triangles).
///
/// Point i, world space, lies on a triangle of the scene that the DAG was built from, and looks
/// along its normal. Rays start bias * visibility_bias(normal) voxels above it. Neighbouring points
/// should follow each other. Runs on all threads of the calling arena; the result does not depend
/// on their number.
///
/// @param normals  as long as positions; unit length. A zero or not finite one, or such a position,
///                 gives 1, nothing in the way
/// @param shadow   empty, or as long as positions: the part of the light that is seen, 0 to 1, of a
///                 lamp with an area by what comes from each part of it; 0 where the surface is
///                 turned away from it
/// @param ambient  empty, or as long as positions: the part of the sky that is seen, by the cosine,
///                 an occluder at distance d counting 1 - d / ao_radius
/// @throws Error   bad_argument where a length or an option is out of range
void visibility(const Dag& dag, const Grid& grid, std::span<const dvec3> positions,
                std::span<const vec3> normals, const VisibilityOptions& options,
                std::span<float> shadow, std::span<float> ambient);

}  // namespace octavo
