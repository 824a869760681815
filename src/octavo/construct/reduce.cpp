// SPDX-License-Identifier: MIT
#include "octavo/construct/reduce.h"

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

void reduce_leaves(NodeStore& store, const std::vector<LeafBlock>& leaves,
                   std::vector<CellNode>& cells) {
    cells.clear();
    for (const LeafBlock& leaf : leaves) cells.push_back({leaf.code, store.add_leaf(leaf.voxels)});
    for (int height = 1; height <= store.top(); ++height) reduce_level(store, height, cells);
}

}  // namespace octavo
