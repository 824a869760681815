// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octavo/core/vec.h"
#include "octavo/voxelize/cut_outs.h"
#include "octavo/voxelize/fixed_point.h"
#include "octavo/voxelize/rule.h"
#include "octavo/voxelize/tile_bitmap.h"

/// Triangles against cells, with the widest SIMD instructions that the machine has. Which ones it
/// has makes no difference to the result.
namespace octavo {

/// A tile has at most 1024 voxels a side: its bitmap is then 128 MiB for each thread.
inline constexpr int kMaxTileDepth = 10;

/// A triangle, and a tile whose closed cube it meets.
struct TileTriangle {
    std::uint32_t tile;      // Morton code of the tile, in tiles
    std::uint32_t triangle;  // index into the FixedMesh

    friend auto operator<=>(const TileTriangle&, const TileTriangle&) = default;
};

/// Appends, for each triangle of [begin, end), the tiles of the grid that it meets.
///
/// @param tile_depth  log2 of a tile's side in voxels; the grid has at most 1024 tiles a side
void find_tiles(const FixedMesh& mesh, std::uint32_t begin, std::uint32_t end, int grid_depth,
                int tile_depth, std::vector<TileTriangle>& out);

/// Marks the voxels of one tile that these triangles meet under the rule, but for the holes.
///
/// @param holes   by the triangle's index in the mesh; null: there are none
/// @param tile    the tile's position, in tiles
/// @param bitmap  of the tile
void rasterize_tile(const FixedMesh& mesh, const HoleLookup* holes,
                    std::span<const TileTriangle> triangles, const uvec3& tile, VoxelRule rule,
                    TileBitmap& bitmap);

/// Names of the SIMD targets that this program was compiled for and this machine has, best first.
[[nodiscard]] std::vector<const char*> simd_targets();

/// Restricts the functions above to one of simd_targets(), or with nullptr lifts the restriction.
/// For tests; not while they run.
void force_simd_target(const char* name);

}  // namespace octavo
