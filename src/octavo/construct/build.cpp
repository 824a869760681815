// SPDX-License-Identifier: MIT
#include "octavo/construct/build.h"

#include <algorithm>
#include <bit>

#include "octavo/construct/construct.h"
#include "octavo/core/parallel.h"
#include "octavo/voxelize/triangle_source.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace octavo {
namespace {

// 256^3: a tile's bitmap is 2 MiB, and what one tile shares with itself is already merged before it
// meets the large tables.
constexpr int kTileDepth = 8;
constexpr int kMaxTilesDepth = 10;

int choose_tile_depth(const BuildOptions& options, int depth) {
    if (options.tile == 0) return std::min(depth, std::max(kTileDepth, depth - kMaxTilesDepth));
    if (!std::has_single_bit(options.tile))
        throw Error(Errc::bad_argument, "a tile's side must be a power of two");
    return std::min(depth, std::countr_zero(options.tile));
}

/// A number that differs where anything does that decides the result or the order of its tiles.
std::uint64_t key_of(const Scene& scene, const Grid& grid, VoxelRule rule,
                     const TriangleSource& source) {
    constexpr std::uint64_t kJournalVersion = 2;
    struct {
        std::uint64_t version, geometry, holes;
        double origin[3], voxel_size;
        std::int64_t depth, tile_depth, rule;
    } const identity = {
        kJournalVersion,
        scene.geometry_hash(),
        source.cut_outs().hash(),
        {grid.origin.x, grid.origin.y, grid.origin.z},
        grid.voxel_size,
        grid.depth,
        source.tile_depth(),
        static_cast<std::int64_t>(rule)};
    return XXH3_64bits(&identity, sizeof identity);
}

}  // namespace

BuildResult build(const Scene& scene, const BuildOptions& options) {
    BuildResult result;
    with_threads(options.threads, [&] {
        result.grid = options.grid ? *options.grid : smallest_cube(scene.bounds(), options.depth);
        report(options.progress, {"sort triangles", 0, 0, 0});
        const int depth = result.grid.depth;
        const TriangleSource source(scene, result.grid, options.rule,
                                    choose_tile_depth(options, depth));
        result.triangles = scene.triangles.size();
        result.degenerate_triangles = source.mesh().degenerate_triangles();
        result.non_finite_triangles = source.mesh().non_finite_triangles();
        result.dag = construct(
            source, depth,
            {.max_memory_bytes = options.max_memory_bytes,
             .progress = options.progress,
             .journal = options.journal,
             .journal_key =
                 options.journal.empty() ? 0 : key_of(scene, result.grid, options.rule, source),
             .journal_interval = options.journal_interval});
    });
    return result;
}

}  // namespace octavo
