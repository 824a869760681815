// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "octavo/core/grid.h"
#include "octavo/core/morton.h"
#include "octavo/core/progress.h"
#include "octavo/mesh/scene.h"
#include "octavo/voxelize/spilled_facets.h"
#include "octavo/voxelize/triangle_source.h"

namespace octavo {

/// A scene's triangles by the tiles of cells that they meet.
class SurfaceTiles {
public:
    /// @param scene         outlives this, unless a scratch folder is given
    /// @param cells         a grid whose voxels are the cells
    /// @param scratch       a folder for temporary files; or empty: all of it is in memory
    /// @param buffer_bytes  how much to sort at once on disk
    /// @throws Error        as TriangleSource; io; cancelled
    SurfaceTiles(const Scene& scene, const Grid& cells, int tile_depth,
                 const std::filesystem::path& scratch, std::uint64_t buffer_bytes,
                 const ProgressFunction& progress);

    [[nodiscard]] int tile_depth() const { return tile_depth_; }

    /// How corners are written.
    [[nodiscard]] const FixedMesh::Frame& frame() const {
        return spilled_ ? spilled_->frame() : in_memory_->mesh().frame();
    }

    /// Calls visit(corners, scene_triangle) for the triangles that meet a tile, in no particular
    /// order; pieces of a triangle that reached far out one by one.
    template <class Visit>
    void for_each(const uvec3& tile, const Visit& visit) const {
        const std::uint64_t code = morton_encode(tile);
        if (spilled_) return spilled_->for_each(static_cast<std::uint32_t>(code), visit);
        const auto& tiles = in_memory_->tiles();
        const auto found = std::lower_bound(tiles.begin(), tiles.end(), code);
        if (found == tiles.end() || *found != code) return;
        const FixedMesh& mesh = in_memory_->mesh();
        std::array<FixedPoint, 3> corners;
        for (const TileTriangle& t :
             in_memory_->triangles(static_cast<std::size_t>(found - tiles.begin())))
            if (mesh.corners(t.triangle, corners)) visit(corners, mesh.scene_triangle(t.triangle));
    }

private:
    int tile_depth_;
    std::optional<TriangleSource> in_memory_;
    std::optional<SpilledFacets> spilled_;
};

}  // namespace octavo
