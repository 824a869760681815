// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "octavo/core/grid.h"
#include "octavo/voxelize/cut_outs.h"
#include "octavo/voxelize/fixed_point.h"
#include "octavo/voxelize/rule.h"
#include "octavo/voxelize/tile_bitmap.h"
#include "octavo/voxelize/tile_rasterizer.h"
#include "octavo/voxelize/voxel_source.h"

namespace octavo {

/// The tile depth, if it suits the grid. @throws Error bad_argument where it does not
[[nodiscard]] int checked_tile_depth(int tile_depth, int grid_depth);

/// A scene's triangles as voxels. Each triangle is sorted once into the tiles that it meets.
///
/// Memory: 16 bytes for each position of the scene, 8 for each pair of a triangle and a tile that
/// it meets, and a bit for each voxel of a tile for each thread.
class TriangleSource final : public VoxelSource {
public:
    /// @param scene       outlives this
    /// @param tile_depth  log2 of a tile's side: 2 to grid.depth, at least grid.depth - 10, and at
    ///                    most 10
    /// @throws Error      bad_argument where tile_depth is out of range; limit where the scene has
    ///                    2^32 triangles or more
    TriangleSource(const Scene& scene, const Grid& grid, VoxelRule rule, int tile_depth)
        : TriangleSource(FixedMesh(scene, grid), CutOuts(scene, grid), grid.depth, rule,
                         tile_depth) {}

    /// For a scene that has been rounded to a grid of this depth: it need not outlive this where it
    /// has no holes and FixedMesh::keep_triangles() took its triangles.
    TriangleSource(FixedMesh mesh, CutOuts cut_outs, int grid_depth, VoxelRule rule,
                   int tile_depth);

    [[nodiscard]] int tile_depth() const override { return tile_depth_; }
    [[nodiscard]] const std::vector<std::uint64_t>& tiles() const override { return tiles_; }
    void voxelize(std::size_t index, TileOctree& octree) const override;
    void forget_before(std::size_t index) override;

    [[nodiscard]] const FixedMesh& mesh() const { return mesh_; }
    [[nodiscard]] const CutOuts& cut_outs() const { return cut_outs_; }

    /// The triangles that meet tiles()[index], in no particular order. Not once it is forgotten.
    [[nodiscard]] std::span<const TileTriangle> triangles(std::size_t index) const {
        return {pairs_.data() + tile_begins_[index], pairs_.data() + tile_begins_[index + 1]};
    }

private:
    void sort_into_tiles(int grid_depth);

    FixedMesh mesh_;
    CutOuts cut_outs_;
    VoxelRule rule_;
    int tile_depth_;
    std::vector<TileTriangle> pairs_;  // sorted
    std::vector<std::uint64_t> tiles_;
    std::vector<std::size_t> tile_begins_;  // into pairs_; one more than there are tiles
    std::size_t forgotten_ = 0;             // of pairs_, from the first on
    mutable tbb::enumerable_thread_specific<TileBitmap> bitmaps_;
};

}  // namespace octavo
