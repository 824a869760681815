// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "octavo/construct/reduce.h"
#include "octavo/core/grid.h"
#include "octavo/core/progress.h"
#include "octavo/dag/dag.h"
#include "octavo/dag/statistics.h"
#include "octavo/mesh/scene.h"
#include "octavo/voxelize/rule.h"

namespace octavo {

/// How to turn a scene into a DAG. Only `depth`, `grid` and `rule` change the result. Every member
/// has a default, so that `{.depth = 8}` compiles without a warning.
struct BuildOptions {
    int depth = 12;                 // resolution 2^depth; not used where `grid` is given
    std::optional<Grid> grid = {};  // none: the smallest cube around the scene
    VoxelRule rule = VoxelRule::conservative;
    int threads = 0;                     // 0: all
    std::uint32_t tile = 0;              // voxels along a tile, a power of two; 0: chosen
    std::uint64_t max_memory_bytes = 0;  // for the whole process; 0: no cap
    /// How many nodes each level of the DAG may come to have, the root's first, as
    /// Estimate::level_nodes has them: tables begin as large and need not grow. Only a matter of
    /// speed; not used under a cap. Empty: nobody knows.
    std::vector<std::uint64_t> expected_nodes = {};
    ReduceFunction reduce = {};  // of tiles, say cuda::make_reducer(); none: on the CPU
    ProgressFunction progress = {};

    /// A folder that the build makes for what it has done and for what the cap leaves no room for,
    /// and deletes when it is done; the folder that it is in is there. Killed or stopped, the next
    /// build with the same scene and options goes on from there and gives the same result. A short
    /// build makes none. Empty: nothing is kept, and a cap that would be passed is an error.
    std::filesystem::path scratch = {};
    std::chrono::milliseconds journal_interval{5000};  // between two writes of what is done

    /// Leaves the scratch folder where it is when the build is done, as the result is not safe yet;
    /// to be deleted by delete_scratch().
    bool keep_scratch = false;

    /// How much of each kind is held in memory before it spills to the scratch folder, where this
    /// is less than what the cap would allow; 0: no limit of its own.
    struct Spill {
        std::uint64_t node_bytes = 0;
        std::uint64_t triangle_bytes = 0;
    } spill = {};
};

struct BuildResult {
    Dag dag;                // built under a cap, its words may be a mapped temporary file
    Statistics statistics;  // of the DAG, counted on the way
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
/// Under a cap, triangles and nodes that it leaves no room for go to the scratch folder
/// (docs/adr/0008-spilling.md). What is counted is the memory that the process has resident, of
/// files that it has mapped as well; a cap that cannot be kept is an error, as soon as it shows.
///
/// @throws Error  io where the scratch cannot be read or written; bad_argument where the options or
///                the scene's bounds allow no grid; limit where the cap or 2^32 words would be
///                passed; cancelled
/// Cost           expected O(voxels touched by triangles); memory: the DAG and its hash tables, the
///                triangles of the scene rounded to the grid, and one tile per thread
[[nodiscard]] BuildResult build(const Scene& scene, const BuildOptions& options);

/// The same for a scene that is not needed any more: its triangles, colours and textures are given
/// back as soon as they are on disk, or, of a scene without holes, rounded to the grid. Cameras and
/// lights stay, and what glows as lamps (mesh_lamps()).
[[nodiscard]] BuildResult build_and_release(Scene& scene, const BuildOptions& options);

}  // namespace octavo
