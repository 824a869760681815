// SPDX-License-Identifier: MIT
#include "sort_levels.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace octavo::bench {
namespace {

struct Cell {
    std::uint32_t code;  // Morton code among the cells of its level
    std::uint32_t node;  // rank among the unique nodes of its level
};

/// Sorts nodes, and gives each cell the rank of its node among the different ones.
template <typename Node>
std::uint32_t rank_nodes(const std::vector<Node>& nodes, std::vector<Cell>& cells) {
    std::vector<std::uint32_t> order(nodes.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return nodes[a] < nodes[b]; });
    std::uint32_t unique = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && nodes[order[i]] != nodes[order[i - 1]]) ++unique;
        cells[order[i]].node = unique;
    }
    return order.empty() ? 0 : unique + 1;
}

}  // namespace

std::uint64_t reduce_by_sorting(const std::vector<LeafBlock>& leaves, int depth) {
    std::vector<Cell> cells(leaves.size());
    std::vector<std::uint64_t> masks(leaves.size());
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        cells[i].code = leaves[i].code;
        masks[i] = leaves[i].voxels;
    }
    std::uint64_t total = rank_nodes(masks, cells);

    constexpr std::uint32_t kNone = 0xffffffffu;
    for (int level = depth - 3; level >= 0; --level) {
        std::vector<std::array<std::uint32_t, 8>> nodes;
        std::vector<Cell> parents;
        for (const Cell& cell : cells) {
            if (parents.empty() || parents.back().code != cell.code >> 3) {
                parents.push_back({cell.code >> 3, 0});
                nodes.emplace_back().fill(kNone);
            }
            nodes.back()[cell.code & 7u] = cell.node;
        }
        total += rank_nodes(nodes, parents);
        cells = std::move(parents);
    }
    return total;
}

}  // namespace octavo::bench
