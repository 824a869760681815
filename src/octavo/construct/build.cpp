// SPDX-License-Identifier: MIT
#include "octavo/construct/build.h"

#include <algorithm>
#include <bit>

#include "octavo/construct/construct.h"
#include "octavo/core/parallel.h"
#include "octavo/voxelize/triangle_source.h"

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
        result.dag = construct(source, depth, {options.max_memory_bytes, options.progress});
    });
    return result;
}

}  // namespace octavo
