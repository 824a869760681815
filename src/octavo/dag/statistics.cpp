// SPDX-License-Identifier: MIT
// Source: [K13] section 5.2 and table 2 for what is counted.
#include "octavo/dag/statistics.h"

#include <bit>
#include <utility>

namespace octavo {
namespace {

/// For every node of one level, how many cells of the octree it stands for. Nodes are two words or
/// more, so half a word index names a node and the array takes no more room than the level.
class Multiplicities {
public:
    Multiplicities(const Dag& dag, int level)
        : begin_(dag.level_begin(level)), counts_((dag.level_begin(level + 1) - begin_ + 1) / 2) {}

    std::uint64_t& operator[](std::uint64_t word) { return counts_[(word - begin_) / 2]; }

private:
    std::uint64_t begin_;
    std::vector<std::uint64_t> counts_;
};

}  // namespace

Statistics compute_statistics(const Dag& dag) {
    Statistics total;
    total.levels.resize(static_cast<std::size_t>(dag.depth()));
    for (int l = 0; l < dag.depth(); ++l) total.levels[static_cast<std::size_t>(l)].level = l;
    if (dag.empty()) return total;

    const int leaf_level = dag.leaf_level();
    Multiplicities cells(dag, 0);
    cells[0] = 1;

    for (int l = 0; l < leaf_level; ++l) {
        LevelStatistics& level = total.levels[static_cast<std::size_t>(l)];
        Multiplicities cells_below(dag, l + 1);
        for (std::uint64_t node = dag.level_begin(l); node < dag.level_begin(l + 1);) {
            const auto size = static_cast<unsigned>(node_words(dag.words()[node]));
            const std::uint64_t count = cells[node];
            level.svo_nodes += count;
            level.dag_nodes += 1;
            level.bytes += size * sizeof(std::uint32_t);
            for (unsigned i = 1; i < size; ++i) cells_below[dag.words()[node + i]] += count;
            node += size;
        }
        cells = std::move(cells_below);
    }

    LevelStatistics& leaves = total.levels[static_cast<std::size_t>(leaf_level)];
    LevelStatistics& inside_leaves = total.levels[static_cast<std::size_t>(leaf_level) + 1];
    for (std::uint64_t word = dag.level_begin(leaf_level); word < dag.level_begin(leaf_level + 1);
         word += kLeafWords) {
        const std::uint64_t voxels = dag.leaf(word);
        const std::uint64_t count = cells[word];
        leaves.svo_nodes += count;
        leaves.dag_nodes += 1;
        leaves.bytes += kLeafWords * sizeof(std::uint32_t);
        inside_leaves.svo_nodes += count * static_cast<unsigned>(std::popcount(leaf_child_mask(voxels)));
        total.voxels += count * static_cast<unsigned>(std::popcount(voxels));
    }

    for (const LevelStatistics& level : total.levels) {
        total.svo_nodes += level.svo_nodes;
        total.dag_nodes += level.dag_nodes;
        total.dag_bytes += level.bytes;
    }
    return total;
}

}  // namespace octavo
