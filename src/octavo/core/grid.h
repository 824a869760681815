// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "octavo/core/box.h"
#include "octavo/core/vec.h"

namespace octavo {

/// N = 2^depth voxels along each side.
inline constexpr int kMinDepth = 2;   // 4^3: a single leaf
inline constexpr int kMaxDepth = 17;  // 131072^3

/// A cube of N x N x N voxels placed in the world.
///
/// World space is the scene's own units. Grid space is voxel units with the origin at the cube's
/// low corner: voxel v is the closed cube [v, v + 1], the whole grid is [0, N]. A cell of level l
/// is 2^(depth - l) voxels wide; level 0 is the grid itself, level depth the voxels.
struct Grid {
    dvec3 origin{0.0};        // world position of the low corner
    double voxel_size = 1.0;  // world units along one side of a voxel
    int depth = kMinDepth;

    [[nodiscard]] std::uint32_t resolution() const { return 1u << depth; }
    [[nodiscard]] double side() const { return voxel_size * resolution(); }
    [[nodiscard]] Box bounds() const { return {origin, origin + side()}; }

    [[nodiscard]] dvec3 to_grid(const dvec3& world) const { return (world - origin) / voxel_size; }
    [[nodiscard]] dvec3 to_world(const dvec3& grid) const { return origin + grid * voxel_size; }

    friend bool operator==(const Grid&, const Grid&) = default;
};

/// The smallest cube that holds the box, centred on the box's centre. A box that is a single point
/// gives a cube of side 1, so that every grid has an inverse transform.
///
/// @param bounds  finite and not empty; world space
/// @param depth   kMinDepth to kMaxDepth
/// @throws Error  bad_argument where the box is empty or not finite, or the depth out of range
[[nodiscard]] Grid smallest_cube(const Box& bounds, int depth);

/// Checks a grid that somebody chose.
/// @throws Error  bad_argument where it is not finite, its voxels have no size, or are so small
///                beside their coordinates that neighbours could not be told apart
void check_grid(const Grid& grid);

/// The depth of a resolution. @throws Error bad_argument unless it is a power of two, 4 to 131072
[[nodiscard]] int depth_of_resolution(std::uint64_t resolution);

}  // namespace octavo
