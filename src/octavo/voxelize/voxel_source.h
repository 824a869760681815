// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/voxelize/tile_octree.h"

namespace octavo {

/// Something that can say which voxels a region of the grid contains. The grid is cut into cubic
/// tiles of 2^tile_depth() voxels a side; each tile is answered on its own, from any thread.
class VoxelSource {
public:
    virtual ~VoxelSource() = default;

    /// log2 of a tile's side in voxels; 2 to the grid's depth.
    [[nodiscard]] virtual int tile_depth() const = 0;

    /// Morton codes, increasing, of the tiles that may contain a voxel. Unit: tiles.
    [[nodiscard]] virtual const std::vector<std::uint64_t>& tiles() const = 0;

    /// Replaces `octree` by the voxels of tiles()[index], in all heights up to tile_depth() - 2.
    /// The result depends on nothing but the source and the tile.
    virtual void voxelize(std::size_t index, TileOctree& octree) const = 0;

    /// Says that the tiles before tiles()[index] are not voxelized any more, so that what is kept
    /// for them alone need not be. Others may be voxelized meanwhile.
    virtual void forget_before([[maybe_unused]] std::size_t index) {}
};

}  // namespace octavo
