// SPDX-License-Identifier: MIT
#include "octavo/construct/reduce.h"

#include <algorithm>
#include <bit>

#include "octavo/voxelize/leaf_vectors.h"

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

// As reduce_upwards(), but for the small tables of a tile: what costs is not memory but branches
// that go either way, so there are few.
void reduce_tile(NodeStore& store, const TileOctree& octree, ReduceScratch& scratch) {
    // Children are read eight at a time.
    if (scratch.nodes.size() < octree.leaves.size() + 8)
        scratch.nodes.resize(octree.leaves.size() + 8);
    std::uint32_t* nodes = scratch.nodes.data();

    UniqueNodes& leaves = store.level(0);
    scratch.recent_leaves.fill(0);  // no leaf is 0
    for (const std::uint64_t leaf : octree.leaves) {
        const std::uint64_t hash = UniqueNodes::hash_leaf(leaf);
        const std::size_t place = hash % ReduceScratch::kRecent;
        if (scratch.recent_leaves[place] != leaf) {
            scratch.recent_leaves[place] = leaf;
            scratch.recent_ids[place] = leaves.add_leaf(leaf, hash);
        }
        *nodes++ = scratch.recent_ids[place];
    }

    for (int height = 1; height <= store.top(); ++height) {
        UniqueNodes& level = store.level(height);
        nodes = scratch.nodes.data();
        const std::uint32_t* children = nodes;
        for (const std::uint32_t mask : octree.child_masks(height)) {
            const int size = std::popcount(mask);
            *nodes++ = level.add_interior(mask, children);
            children += size;
        }
    }
}

void count_cells(const TileOctree& octree, int top, OctreeCounts& counts) {
    const LeafCounts leaves = count_leaves(octree.leaves);
    counts.voxels += leaves.voxels;
    counts.cells[0] += leaves.children;
    for (int height = 0; height <= top; ++height) counts.at_height(height) += octree.count(height);
}

}  // namespace octavo
