// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>

#include "octavo/construct/build.h"
#include "octavo/construct/scratch.h"
#include "octavo/voxelize/voxel_source.h"

namespace octavo {

/// What is settled before a build begins. Processes that build together have the same.
struct BuildPlan {
    Grid grid;
    int tile_depth = 0;
    std::uint64_t key = 0;  // differs where anything does that decides the result or the tiles;
                            // 0 where there is no scratch
};

/// @throws Error bad_argument where the options or the scene's bounds allow no grid
[[nodiscard]] BuildPlan plan_build(const Scene& scene, const BuildOptions& options);

/// A scene's triangles, ready to be voxelized, in memory or on disk as the options want it.
struct SortedTriangles {
    std::unique_ptr<VoxelSource> source;
    std::uint64_t count = 0, degenerate = 0, non_finite = 0;
};

/// @param disposable  the scene, if it may be given up once it is not needed; or null
[[nodiscard]] SortedTriangles sort_triangles(const Scene& scene, Scene* disposable,
                                             const BuildPlan& plan, const BuildOptions& options,
                                             Scratch& scratch);

}  // namespace octavo
