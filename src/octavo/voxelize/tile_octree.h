// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace octavo {

/// A 4x4x4 block of voxels: a leaf of the DAG, and where it is.
struct LeafBlock {
    std::uint64_t voxels;  // not zero; bit b is the voxel with Morton code b in the block
    std::uint32_t code;    // Morton code of the block inside its tile
};

/// The voxels of one tile as an octree without pointers: what each of its levels holds, in Morton
/// order. Levels are counted from the leaves: a node of height h is 2^(h + 2) voxels wide, and the
/// tile is the one node of the greatest height, unless it is empty.
struct TileOctree {
    /// Of a tile of 1024^3 voxels.
    static constexpr int kMaxTop = 8;

    std::vector<std::uint64_t> leaves;  // voxels of the blocks that have one, as in LeafBlock
    std::array<std::vector<std::uint8_t>, kMaxTop> masks;  // [h - 1]: the nodes of height h

    [[nodiscard]] bool empty() const { return leaves.empty(); }

    /// The child masks of the nodes of a height from 1: bit i is set where child i is there.
    [[nodiscard]] std::vector<std::uint8_t>& child_masks(int height) {
        return masks[static_cast<unsigned>(height - 1)];
    }
    [[nodiscard]] const std::vector<std::uint8_t>& child_masks(int height) const {
        return masks[static_cast<unsigned>(height - 1)];
    }

    /// How many nodes there are of a height from 0.
    [[nodiscard]] std::size_t count(int height) const {
        return height == 0 ? leaves.size() : child_masks(height).size();
    }
};

/// The octree that has these leaves, in a tile whose root has this height. They are in Morton
/// order.
[[nodiscard]] TileOctree octree_of(std::span<const LeafBlock> blocks, int top);

/// Its leaves, and where they are.
[[nodiscard]] std::vector<LeafBlock> blocks_of(const TileOctree& octree, int top);

}  // namespace octavo
