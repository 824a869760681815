// SPDX-License-Identifier: MIT
#include "octavo/construct/build.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <utility>

#include "octavo/construct/build_plan.h"
#include "octavo/construct/construct.h"
#include "octavo/construct/scratch.h"
#include "octavo/core/memory.h"
#include "octavo/core/parallel.h"
#include "octavo/mesh/mesh_lamps.h"
#include "octavo/voxelize/cut_outs.h"
#include "octavo/voxelize/spilled_triangles.h"
#include "octavo/voxelize/triangle_source.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace octavo {
namespace {

// 256^3: a tile's bitmap is 2 MiB, and what one tile shares with itself is already merged before it
// meets the large tables.
constexpr int kTileDepth = 8;
constexpr int kMaxTilesDepth = 10;

// Where memory is scarce, tiles of 128^3: in the worst case one takes 2 MiB instead of 14.
constexpr int kSmallTileDepth = 7;
constexpr std::uint64_t kScarceBytesPerThread = std::uint64_t{256} << 20;

int choose_tile_depth(const BuildOptions& options, int depth) {
    if (options.tile == 0) {
        const auto threads =
            static_cast<std::uint64_t>(options.threads > 0 ? options.threads : available_threads());
        const bool scarce = options.max_memory_bytes != 0 &&
                            options.max_memory_bytes / threads < kScarceBytesPerThread;
        return std::min(depth,
                        std::max(scarce ? kSmallTileDepth : kTileDepth, depth - kMaxTilesDepth));
    }
    if (!std::has_single_bit(options.tile))
        throw Error(Errc::bad_argument, "a tile's side must be a power of two");
    return std::min(depth, std::countr_zero(options.tile));
}

/// What TriangleSource takes for a scene: its points, and pairs of triangles and tiles, of which
/// there are a few for each small triangle and a few for each tile of a large one.
std::uint64_t triangle_memory(const Scene& scene, int tiles_depth) {
    const std::uint64_t tiles_on_surfaces = std::uint64_t{12} << 2 * tiles_depth;
    return 16 * scene.positions.size() + 16 * (3 * scene.triangles.size() + tiles_on_surfaces);
}

/// How many bytes of triangles to sort at a time on disk; 0: they have room in memory.
std::uint64_t triangle_buffer(const Scene& scene, const BuildOptions& options, int tiles_depth) {
    if (options.scratch.empty()) return 0;
    if (options.spill.triangle_bytes != 0) return options.spill.triangle_bytes;
    if (options.max_memory_bytes == 0) return 0;
    const std::uint64_t resident = resident_bytes();
    const std::uint64_t left =
        options.max_memory_bytes > resident ? options.max_memory_bytes - resident : 0;
    if (triangle_memory(scene, tiles_depth) <= left / 4) return 0;
    return std::max(std::uint64_t{4} << 20, left / 4);
}

/// Leaves of a scene what a build does not need. @return its triangles
std::vector<uvec3> drop_geometry(Scene& scene) {
    Scene rest;
    rest.cameras = std::move(scene.cameras);
    std::vector<Light> glowing = mesh_lamps(scene);
    rest.lights = std::move(scene.lights);
    std::ranges::move(glowing, std::back_inserter(rest.lights));
    rest.warnings = std::move(scene.warnings);
    std::vector<uvec3> triangles = std::move(scene.triangles);
    scene = std::move(rest);
    trim_memory();
    return triangles;
}

/// A number that differs where anything does that decides the result or the order of its tiles.
std::uint64_t key_of(const Scene& scene, const Grid& grid, VoxelRule rule, int tile_depth) {
    constexpr std::uint64_t kJournalVersion = 4;
    struct {
        std::uint64_t version, geometry, holes;
        double origin[3], voxel_size;
        std::int64_t depth, tile_depth, rule;
    } const identity = {kJournalVersion,
                        scene.geometry_hash(),
                        CutOuts(scene, grid).hash(),
                        {grid.origin.x, grid.origin.y, grid.origin.z},
                        grid.voxel_size,
                        grid.depth,
                        tile_depth,
                        static_cast<std::int64_t>(rule)};
    return XXH3_64bits(&identity, sizeof identity);
}

}  // namespace

BuildPlan plan_build(const Scene& scene, const BuildOptions& options) {
    BuildPlan plan;
    plan.grid = options.grid ? *options.grid : smallest_cube(scene.bounds(), options.depth);
    plan.tile_depth = choose_tile_depth(options, plan.grid.depth);
    if (!options.scratch.empty())
        plan.key = key_of(scene, plan.grid, options.rule, plan.tile_depth);
    return plan;
}

SortedTriangles sort_triangles(const Scene& scene, Scene* disposable, const BuildPlan& plan,
                               const BuildOptions& options, Scratch& scratch) {
    report(options.progress, {"sort triangles", 0, 0, 0});
    SortedTriangles sorted;
    sorted.count = scene.triangles.size();
    const int tiles_depth = plan.grid.depth - plan.tile_depth;
    if (const auto buffer = triangle_buffer(scene, options, tiles_depth)) {
        scratch.open();
        auto source = std::make_unique<SpilledTriangles>(
            scene, plan.grid, options.rule, plan.tile_depth,
            DiskSort{scratch.folder() / "triangles", buffer, options.progress});
        sorted.degenerate = source->degenerate_triangles();
        sorted.non_finite = source->non_finite_triangles();
        sorted.source = std::move(source);
        if (disposable != nullptr) (void)drop_geometry(*disposable);
    } else {
        FixedMesh mesh(scene, plan.grid);
        CutOuts cut_outs(scene, plan.grid);
        // Holes are found in the scene. Without them it goes before the triangles are sorted.
        if (disposable != nullptr && cut_outs.empty())
            mesh.keep_triangles(drop_geometry(*disposable));
        sorted.degenerate = mesh.degenerate_triangles();
        sorted.non_finite = mesh.non_finite_triangles();
        auto source = std::make_unique<TriangleSource>(
            std::move(mesh), std::move(cut_outs), plan.grid.depth, options.rule, plan.tile_depth);
        sorted.source = std::move(source);
    }
    return sorted;
}

namespace {

BuildResult build_from(const Scene& scene, Scene* disposable, const BuildOptions& options) {
    BuildResult result;
    with_threads(options.threads, [&] {
        const BuildPlan plan = plan_build(scene, options);
        Scratch scratch(options.scratch, plan.key, plan.tile_depth - 2);
        const SortedTriangles sorted = sort_triangles(scene, disposable, plan, options, scratch);
        Constructed constructed = construct(*sorted.source, plan.grid.depth,
                                            {.max_memory_bytes = options.max_memory_bytes,
                                             .max_store_bytes = options.spill.node_bytes,
                                             .expected_nodes = options.expected_nodes,
                                             .reduce = options.reduce,
                                             .progress = options.progress,
                                             .journal_interval = options.journal_interval},
                                            scratch);
        result = {std::move(constructed.dag),
                  std::move(constructed.statistics),
                  plan.grid,
                  sorted.count,
                  sorted.degenerate,
                  sorted.non_finite};
        if (!options.keep_scratch) scratch.remove();
    });
    return result;
}

}  // namespace

BuildResult build(const Scene& scene, const BuildOptions& options) {
    return build_from(scene, nullptr, options);
}

BuildResult build_and_release(Scene& scene, const BuildOptions& options) {
    return build_from(scene, &scene, options);
}

}  // namespace octavo
