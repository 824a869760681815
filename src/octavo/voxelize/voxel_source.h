// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace octavo {

/// One 4x4x4 block of voxels: a leaf of the DAG, and where it is.
struct LeafBlock {
    std::uint64_t voxels;  // not zero; bit b is the voxel with Morton code b in the block
    std::uint32_t code;    // Morton code of the block inside its tile
};

/// Something that can say which voxels a region of the grid contains. The grid is cut into cubic tiles
/// of 2^tile_depth() voxels a side; each tile is answered on its own, from any thread.
class VoxelSource {
public:
    virtual ~VoxelSource() = default;

    /// log2 of a tile's side in voxels; 2 to the grid's depth.
    [[nodiscard]] virtual int tile_depth() const = 0;

    /// Morton codes, increasing, of the tiles that may contain a voxel. Unit: tiles.
    [[nodiscard]] virtual const std::vector<std::uint64_t>& tiles() const = 0;

    /// Fills `leaves` with the blocks of tiles()[index] that have a voxel, in Morton order. The result
    /// depends on nothing but the source and the tile.
    virtual void voxelize(std::size_t index, std::vector<LeafBlock>& leaves) const = 0;
};

}  // namespace octavo
