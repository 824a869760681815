// SPDX-License-Identifier: MIT
#include "octavo/construct/reduce.h"

#include <algorithm>
#include <bit>

namespace octavo {

void reduce_level(NodeStore& store, int height, std::vector<CellNode>& cells) {
    UniqueNodes& nodes = store.level(height);
    std::size_t parents = 0;
    for (std::size_t i = 0; i < cells.size();) {
        const std::uint32_t parent = cells[i].code >> 3;
        std::uint32_t words[kMaxNodeWords] = {};
        int size = 1;
        for (; i < cells.size() && cells[i].code >> 3 == parent; ++i) {
            words[0] |= 1u << (cells[i].code & 7u);
            words[size++] = cells[i].node;
        }
        cells[parents++] = {parent, nodes.add(words)};
    }
    cells.resize(parents);
}

void reduce_upwards(NodeStore& store, int from_height, std::vector<CellNode>& cells,
                    OctreeCounts& counts) {
    for (int height = from_height; height <= store.top(); ++height) {
        reduce_level(store, height, cells);
        counts.at_height(height) += cells.size();
    }
}

namespace {

/// How many of a leaf's 2x2x2 children have a voxel: bytes that are not zero.
int child_count(std::uint64_t leaf) {
    constexpr std::uint64_t kLow = 0x7f7f7f7f7f7f7f7fu;
    return std::popcount((((leaf & kLow) + kLow) | leaf) & ~kLow);
}

/// Replaces the codes of cells by those of their parents, and finds the parents' child masks.
/// @return how many there are
std::size_t group_siblings(std::size_t count, ReduceScratch& cells) {
    std::uint32_t* codes = cells.codes.data();
    std::uint8_t* masks = cells.child_masks.data();
    codes[count] = ~codes[count - 1];  // of another parent
    std::size_t parents = 0;
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < count; ++i) {
        // Without a branch: groups have any size, so none could be foretold.
        const std::uint32_t code = codes[i];
        const bool last = (code ^ codes[i + 1]) > 7u;
        mask |= 1u << (code & 7u);
        masks[parents] = static_cast<std::uint8_t>(mask);
        codes[parents] = code >> 3;
        parents += last;
        mask = last ? 0 : mask;
    }
    return parents;
}

}  // namespace

// As reduce_upwards(), but for the small tables of a tile: what costs is not memory but branches
// that go either way, so there are few.
void reduce_leaves(NodeStore& store, const std::vector<LeafBlock>& leaves, ReduceScratch& scratch,
                   OctreeCounts& counts) {
    std::size_t count = leaves.size();
    if (scratch.codes.size() < count + 1) {
        scratch.codes.resize(count + 1);
        scratch.nodes.resize(count + 8);  // children are read eight at a time
        scratch.child_masks.resize(count);
    }
    UniqueNodes& level = store.level(0);
    std::uint64_t voxels = 0, children = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const LeafBlock& leaf = leaves[i];
        scratch.codes[i] = leaf.code;
        scratch.nodes[i] = level.add_leaf(leaf.voxels);
        voxels += static_cast<unsigned>(std::popcount(leaf.voxels));
        children += static_cast<unsigned>(child_count(leaf.voxels));
    }
    counts.voxels += voxels;
    counts.cells[0] += children;
    counts.at_height(0) += count;

    for (int height = 1; height <= store.top(); ++height) {
        count = group_siblings(count, scratch);
        UniqueNodes& nodes = store.level(height);
        const std::uint32_t* ids = scratch.nodes.data();
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t mask = scratch.child_masks[i];
            const int size = std::popcount(mask);
            scratch.nodes[i] = nodes.add_interior(mask, ids);
            ids += size;
        }
        counts.at_height(height) += count;
    }
}

void count_cells(const std::vector<LeafBlock>& leaves, int top, OctreeCounts& counts) {
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        const LeafBlock& leaf = leaves[i];
        counts.voxels += static_cast<unsigned>(std::popcount(leaf.voxels));
        counts.cells[0] += static_cast<unsigned>(std::popcount(leaf_child_mask(leaf.voxels)));
        // The highest bit in which two neighbours in Morton order differ tells how high their
        // ancestors do.
        int differ = top + 1;
        if (i > 0) differ = (std::bit_width(leaf.code ^ leaves[i - 1].code) + 2) / 3;
        for (int height = 0; height < std::min(differ, top + 1); ++height)
            ++counts.at_height(height);
    }
}

}  // namespace octavo
