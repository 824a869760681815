// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "octavo/dag/dag.h"

namespace octavo::test {

/// Builds DAGs bottom-up, one node at a time, in the plainest way: an oracle, not a constructor.
class SmallDagBuilder {
public:
    explicit SmallDagBuilder(int depth) : depth_(depth), levels_(static_cast<std::size_t>(depth)) {}

    /// A number for this leaf, the same for equal leaves; 0 for an empty one.
    std::uint32_t leaf(std::uint64_t voxels);

    /// A number for the node of this level with these children (0: none); 0 where all are 0.
    std::uint32_t node(int level, const std::array<std::uint32_t, 8>& children);

    /// The DAG below this root: a node of level 0, or a leaf where the depth is 2.
    [[nodiscard]] Dag freeze(std::uint32_t root) const;

private:
    struct Level {
        std::map<std::array<std::uint32_t, 8>, std::uint32_t> numbers;
        std::vector<std::array<std::uint32_t, 8>> nodes;  // number n is nodes[n - 1]
    };
    int depth_;
    std::vector<Level> levels_;  // a leaf is {low word, high word, 0 ...}
};

/// Every voxel for which `voxel` is true; `may_hold` says false only of cubes without any.
Dag dag_of(int depth, const std::function<bool(const uvec3& corner, std::uint32_t width)>& may_hold,
           const std::function<bool(const uvec3&)>& voxel);

/// The voxels within 0.87 of the surface where the distance is zero (any bound of it that changes
/// by at most one for each voxel of way); grid space.
Dag dag_of_distance(int depth, const std::function<double(const dvec3&)>& distance);

/// Each node has each child with probability `density`, of a few nodes for each level: full of
/// holes of every size at any depth.
Dag dust(int depth, double density, std::uint32_t seed);

/// Every voxel: one node for each level, whose eight pointers are the same.
Dag full_grid(int depth);

/// The voxels with 0 <= a.v - offset < |a.x| + |a.y| + |a.z|: a slanted wall without holes.
Dag slanted_wall(int depth, const ivec3& a, std::int64_t offset);

}  // namespace octavo::test
