// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>

/// Layout of one node and of one leaf in the DAG's array of 32-bit words ([K13] figure 3, [B18]).
///
///   interior node, 1 to 8 children:            leaf, a 4x4x4 block of voxels:
///     word 0      ........ ........ ........ mmmmmmmm    word 0   voxels  0 .. 31 (z = 0, 1)
///                 |   24 spare bits, zero   | child mask   word 1   voxels 32 .. 63 (z = 2, 3)
///     word 1 ...  word index of each existing child,
///                 in child order
///
/// Child i of a node, and child i of the block inside a leaf:
///
///        6 ---- 7        i = x + 2y + 4z
///       /|     /|
///      4 ---- 5 |        y  z
///      | 2 ---| 3        | /
///      |/     |/         |/
///      0 ---- 1          +---- x
///
/// Voxel bit b of a leaf is the voxel's Morton code inside the block, so byte i of the 64 bits is
/// the child mask of its 2x2x2 child i: the last two levels of the tree, without a pointer.
///
/// The spare bits are zero in format version 1 and a reader refuses anything else: they are kept
/// for counts that attributes will need ([B18]), which must not be mistaken for a mask by older
/// readers.
namespace octavo {

inline constexpr std::uint32_t kChildMaskBits = 0xffu;
inline constexpr int kLeafWords = 2;
inline constexpr int kMaxNodeWords = 9;

/// Words that a node with this child mask takes.
[[nodiscard]] constexpr int node_words(std::uint32_t child_mask) {
    return 1 + std::popcount(child_mask & kChildMaskBits);
}

/// Where the pointer to child i lies, counted from the node's first word. The child must exist.
[[nodiscard]] constexpr int child_offset(std::uint32_t child_mask, int i) {
    return 1 + std::popcount(child_mask & ((1u << i) - 1u));
}

/// Mask of the 2x2x2 children of a leaf that hold a voxel: bit i set when byte i is not zero.
[[nodiscard]] constexpr std::uint32_t leaf_child_mask(std::uint64_t leaf) {
    leaf |= leaf >> 4;
    leaf |= leaf >> 2;
    leaf |= leaf >> 1;
    leaf &= 0x0101010101010101u;
    return static_cast<std::uint32_t>((leaf * 0x0102040810204080u) >> 56);
}

}  // namespace octavo
