// SPDX-License-Identifier: MIT
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "octavo/core/grid.h"
#include "octavo/core/spill_file.h"
#include "octavo/mesh/scene.h"
#include "octavo/voxelize/cut_outs.h"
#include "octavo/voxelize/rule.h"
#include "octavo/voxelize/spilled_facets.h"
#include "octavo/voxelize/tile_bitmap.h"
#include "octavo/voxelize/voxel_source.h"

namespace octavo {

/// A scene's triangles as voxels, as TriangleSource has them, from disk: the scene is not needed
/// any more once this is made. Where triangles have holes, the textures' pixels that are solid stay
/// in memory, and how each such triangle lies on them goes to disk too.
///
/// Memory: that of SpilledFacets, and for each thread a tile's bits.
class SpilledTriangles final : public VoxelSource {
public:
    /// @param tile_depth  as TriangleSource
    /// @param sort        another temporary file is made beside this one
    /// @throws Error      as TriangleSource; io; cancelled
    SpilledTriangles(const Scene& scene, const Grid& grid, VoxelRule rule, int tile_depth,
                     const DiskSort& sort);

    [[nodiscard]] int tile_depth() const override { return facets_.tile_depth(); }
    [[nodiscard]] const std::vector<std::uint64_t>& tiles() const override {
        return facets_.tiles();
    }
    void voxelize(std::size_t index, TileOctree& octree) const override;

    [[nodiscard]] std::uint64_t degenerate_triangles() const {
        return facets_.degenerate_triangles();
    }
    [[nodiscard]] std::uint64_t non_finite_triangles() const {
        return facets_.non_finite_triangles();
    }
    [[nodiscard]] std::size_t runs() const { return facets_.runs(); }

private:
    static constexpr std::uint32_t kNoHoles = 0xffffffffu;  // else an index into holes_file_
    class Batch;

    void number_by_holes(std::size_t begin, std::span<std::uint32_t> numbers);

    VoxelRule rule_;
    CutOuts cut_outs_;
    std::unique_ptr<SpillFile> holes_file_;  // a CutOuts::Triangle for each that has holes
    std::uint32_t hole_count_ = 0;
    SpilledFacets facets_;
    mutable tbb::enumerable_thread_specific<TileBitmap> bitmaps_;
};

}  // namespace octavo
