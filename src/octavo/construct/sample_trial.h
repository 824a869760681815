// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "octavo/construct/build.h"
#include "octavo/construct/octree_counts.h"
#include "octavo/construct/sampled_nodes.h"
#include "octavo/construct/sampled_tiles.h"
#include "octavo/core/grid.h"
#include "octavo/dag/statistics.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// What building a sample of a scene's tiles has told and taken.
struct SampleTrial {
    TileSample sample;   // of which the tiles are
    int tile_depth = 0;  // 2^tile_depth voxels along each
    double sort_seconds = 0.0;
    double tile_seconds = 0.0;
    double triangles = 0.0;  // sorted
    double missing = 0.0;    // part of its share of the scene's triangles that the sample lacks
    OctreeCounts counts = {};

    /// Of the tiles with voxels.
    struct Sums {
        double tiles = 0.0;
        double square_voxels = 0.0;              // each tile's, squared
        double nodes = 0.0, square_nodes = 0.0;  // that no tile before has
    } sums = {};

    /// Of each height from the leaves up to a tile.
    struct Level {
        std::array<double, SampledNodes::kPieces> nodes{};  // growth_curve()
        double bytes_per_node = 0.0;
    };
    std::vector<Level> levels = {};
    Statistics whole = {};  // of the DAG, where the sample is all

    /// How far what is told from these tiles may be off, as a part of it: three standard deviations
    /// between samples of the same rarity (Horvitz and Thompson). Where triangles are missing there
    /// is more of something in other tiles.
    [[nodiscard]] double voxel_error() const {
        return error_of(static_cast<double>(counts.voxels), sums.square_voxels);
    }
    [[nodiscard]] double node_error() const {
        return std::max(missing, error_of(sums.nodes, sums.square_nodes));
    }

    /// Of building all tiles, and so many triangles, on the same threads.
    [[nodiscard]] double seconds(double all_triangles) const;

private:
    [[nodiscard]] double error_of(double sum, double squares) const;
};

/// Builds a sample of a scene's tiles, at random places: one in 64, or more of a grid below 4096^3,
/// up to all from 512^3 down; and more where these tell too little and more cost little, fewer
/// where a cap leaves no room for so many.
///
/// @param options  those of the build
/// @throws Error   io; cancelled
[[nodiscard]] SampleTrial try_sample(const Scene& scene, const BuildOptions& options,
                                     const Grid& grid);

}  // namespace octavo
