// SPDX-License-Identifier: MIT
#include "octavo/voxelize/triangle_source.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <limits>
#include <string>
#include <utility>

#include "octavo/core/error.h"
#include "octavo/core/memory.h"
#include "octavo/core/morton.h"
#include "octavo/core/radix_sort.h"

namespace octavo {
namespace {

constexpr int kMaxTilesDepth = 10;  // so that a tile's Morton code fits 32 bits

}  // namespace

int checked_tile_depth(int tile_depth, int grid_depth) {
    if (tile_depth < 2 || tile_depth > grid_depth || tile_depth > kMaxTileDepth ||
        grid_depth - tile_depth > kMaxTilesDepth)
        throw Error(Errc::bad_argument,
                    "a tile of " + std::to_string(1 << tile_depth) +
                        " voxels does not suit a grid of " + std::to_string(1 << grid_depth) +
                        ": a tile has 4 to 1024 voxels a side and a grid at most 1024 tiles");
    return tile_depth;
}

TriangleSource::TriangleSource(FixedMesh mesh, CutOuts cut_outs, int grid_depth, VoxelRule rule,
                               int tile_depth)
    : mesh_(std::move(mesh)),
      cut_outs_(std::move(cut_outs)),
      rule_(rule),
      tile_depth_(checked_tile_depth(tile_depth, grid_depth)),
      bitmaps_([tile_depth] { return TileBitmap(tile_depth); }) {
    if (mesh_.size() > std::numeric_limits<std::uint32_t>::max())
        throw Error(Errc::limit, "a scene can have at most 2^32 - 1 triangles");
    sort_into_tiles(grid_depth);
}

void TriangleSource::sort_into_tiles(int grid_depth) {
    constexpr std::uint32_t kGrain = 1 << 13;
    tbb::enumerable_thread_specific<std::vector<TileTriangle>> found;
    const auto count = static_cast<std::uint32_t>(mesh_.size());
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, kGrain), [&](const auto& r) {
        find_tiles(mesh_, r.begin(), r.end(), grid_depth, tile_depth_, found.local());
    });

    // The order of a tile's triangles makes no difference to its voxels.
    std::vector<std::vector<TileTriangle>> parts;
    for (auto& part : found) parts.push_back(std::move(part));
    pairs_ = radix_sort_parts(parts, 3 * (grid_depth - tile_depth_),
                              [](const TileTriangle& pair) { return pair.tile; });

    for (std::size_t i = 0; i < pairs_.size(); ++i) {
        if (i > 0 && pairs_[i].tile == pairs_[i - 1].tile) continue;
        tiles_.push_back(pairs_[i].tile);
        tile_begins_.push_back(i);
    }
    tile_begins_.push_back(pairs_.size());
}

void TriangleSource::voxelize(std::size_t index, TileOctree& octree) const {
    struct Holes final : HoleLookup {
        Holes(const FixedMesh& of_mesh, const CutOuts& of_scene)
            : mesh(of_mesh), cut_outs(of_scene) {}
        bool find(std::size_t triangle, CutOuts::Triangle& out) const override {
            return cut_outs.find(mesh.scene_triangle(triangle), out);
        }
        const FixedMesh& mesh;
        const CutOuts& cut_outs;
    } const holes(mesh_, cut_outs_);
    TileBitmap& bitmap = bitmaps_.local();
    rasterize_tile(mesh_, cut_outs_.empty() ? nullptr : &holes, triangles(index),
                   morton_decode(tiles_[index]), rule_, bitmap);
    bitmap.take(octree);
}

void TriangleSource::forget_before(std::size_t index) {
    // To ask the system for each tile would take longer than the tile.
    constexpr std::size_t kAtOnce = (std::size_t{1} << 20) / sizeof(TileTriangle);
    const std::size_t end = tile_begins_[index];
    if (end - forgotten_ < kAtOnce) return;
    discard_pages(pairs_.data() + forgotten_, (end - forgotten_) * sizeof(TileTriangle));
    forgotten_ = end;
}

}  // namespace octavo
