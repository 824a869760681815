// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <tuple>

#include "octavo/core/grid.h"
#include "octavo/mesh/scene.h"
#include "octavo/voxelize/fixed_point.h"
#include "octavo/voxelize/rule.h"

/// The voxel rules once more, written for clarity and from other theory than the code under test, in
/// 128-bit integers: separating axes for `conservative`, the definition on the voxel's centre for `thin`.
namespace octavo::test {

/// Does the closed triangle meet the closed voxel, or obey the thin rule?
[[nodiscard]] bool meets(const std::array<FixedPoint, 3>& corners, const FixedMesh& mesh,
                         const ivec3& voxel, VoxelRule rule);

using VoxelSet = std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>>;

/// All voxels of the grid that a triangle of the scene marks. Cost: for each triangle, every voxel
/// within one of its bounds.
[[nodiscard]] VoxelSet brute_force_voxels(const Scene& scene, const Grid& grid, VoxelRule rule);

}  // namespace octavo::test
