// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/core/morton.h"
#include "octavo/voxelize/voxel_source.h"
#include "voxelize/brute_force.h"

namespace octavo::test {

/// All voxels that a source reports.
inline VoxelSet voxels_of(const VoxelSource& source) {
    VoxelSet voxels;
    TileOctree octree;
    for (std::size_t i = 0; i < source.tiles().size(); ++i) {
        source.voxelize(i, octree);
        const uvec3 tile = morton_decode(source.tiles()[i])
                           << static_cast<unsigned>(source.tile_depth());
        for (const LeafBlock& leaf : blocks_of(octree, source.tile_depth() - 2))
            for (std::uint32_t b = 0; b < 64; ++b)
                if (leaf.voxels >> b & 1u) {
                    const uvec3 v = tile + (morton_decode(leaf.code) << 2u) + morton_decode(b);
                    voxels.emplace(v.x, v.y, v.z);
                }
    }
    return voxels;
}

}  // namespace octavo::test
