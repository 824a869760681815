// SPDX-License-Identifier: MIT
#include "octavo/construct/reduce.h"

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

void reduce_leaves(NodeStore& store, const std::vector<LeafBlock>& leaves,
                   std::vector<CellNode>& cells, OctreeCounts& counts) {
    cells.clear();
    for (const LeafBlock& leaf : leaves) {
        cells.push_back({leaf.code, store.add_leaf(leaf.voxels)});
        counts.voxels += static_cast<unsigned>(std::popcount(leaf.voxels));
        counts.cells[0] += static_cast<unsigned>(std::popcount(leaf_child_mask(leaf.voxels)));
    }
    counts.at_height(0) += leaves.size();
    reduce_upwards(store, 1, cells, counts);
}

}  // namespace octavo
