// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "octavo/core/grid.h"
#include "octavo/core/progress.h"
#include "octavo/dag/dag.h"
#include "octavo/mesh/scene.h"
#include "octavo/voxelize/rule.h"

namespace octavo {

/// How to turn a scene into a DAG. Only `depth`, `grid` and `rule` change the result.
struct BuildOptions {
    int depth = 12;            // resolution 2^depth; not used where `grid` is given
    std::optional<Grid> grid;  // none: the smallest cube around the scene
    VoxelRule rule = VoxelRule::conservative;
    int threads = 0;                     // 0: all
    std::uint32_t tile = 0;              // voxels along a tile, a power of two; 0: chosen
    std::uint64_t max_memory_bytes = 0;  // for the whole process; 0: no cap
    ProgressFunction progress;

    /// A file that a long build keeps beside it: killed or stopped, the next build with the same
    /// scene and options goes on from there and gives the same result. Empty: none is kept. It is
    /// written every few seconds, so a short build makes none, and deleted when the build is done.
    std::filesystem::path journal;
    std::chrono::milliseconds journal_interval{5000};
};

struct BuildResult {
    Dag dag;
    Grid grid;
    std::uint64_t triangles = 0;             // in the scene
    std::uint64_t degenerate_triangles = 0;  // zero area on the fixed-point grid; still voxelized
    std::uint64_t non_finite_triangles = 0;  // a NaN or infinite corner; not voxelized
};

/// Voxelizes a scene and reduces the voxels to the minimal DAG, tile by tile, without ever holding
/// the octree ([K13] section 3). The result does not depend on threads, tile, memory cap or the
/// order of the triangles. Textures with alpha make holes only once decode_textures() has been
/// called.
///
/// @throws Error  io where the journal cannot be read or written; bad_argument where the options or
/// the scene's bounds allow no grid; limit where the
///                cap or 2^32 words would be passed; cancelled
/// Cost           expected O(voxels touched by triangles); memory: the DAG and its hash tables, the
///                triangles of the scene rounded to the grid, and one tile per thread
[[nodiscard]] BuildResult build(const Scene& scene, const BuildOptions& options);

}  // namespace octavo
