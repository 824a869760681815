// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "octavo/core/grid.h"
#include "octavo/core/vec.h"
#include "octavo/mesh/scene.h"
#include "octavo/voxelize/voxel_source.h"

namespace octavo {

/// A part of a grid's tiles, chosen by a hash of where they are: as good as at random, and always
/// the same.
struct TileSample {
    int rarity = 0;          // one tile of 4^rarity
    std::uint64_t part = 0;  // which of the 4^rarity samples

    [[nodiscard]] bool has(const uvec3& tile) const;

    /// Which of the sixteen samples that make up this one a tile of it is in.
    [[nodiscard]] unsigned piece_of(const uvec3& tile) const;
};

/// The numbers of the triangles that may meet a tile of the sample: of all whose bounds do, and of
/// those with wide bounds. Cost: one pass over the triangles, parallel.
[[nodiscard]] std::vector<std::size_t> triangles_in_sample(const Scene& scene, const Grid& grid,
                                                           int tile_depth,
                                                           const TileSample& sample);

/// A scene of these triangles of another one, bare of colours and holes.
[[nodiscard]] Scene bare_scene(const Scene& scene, const std::vector<std::size_t>& triangles);
inline constexpr std::uint64_t kBareTriangleBytes = 3 * sizeof(dvec3) + sizeof(uvec3);

/// Another source's tiles that are in the sample.
class SampledTiles final : public VoxelSource {
public:
    /// @param source  outlives this
    SampledTiles(const VoxelSource& source, const TileSample& sample);

    [[nodiscard]] int tile_depth() const override { return source_.tile_depth(); }
    [[nodiscard]] const std::vector<std::uint64_t>& tiles() const override { return tiles_; }
    void voxelize(std::size_t index, TileOctree& octree) const override {
        source_.voxelize(indices_[index], octree);
    }

private:
    const VoxelSource& source_;
    std::vector<std::uint64_t> tiles_;
    std::vector<std::size_t> indices_;  // of tiles_ in the source
};

}  // namespace octavo
