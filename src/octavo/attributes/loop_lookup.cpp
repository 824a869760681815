// SPDX-License-Identifier: MIT
// Source: [J], the look-up of a node's colour.
#include "octavo/attributes/loop_lookup.h"

namespace octavo {
namespace {

/// A cell of the octree: a node, or a part of a leaf.
struct Cell {
    std::uint64_t node = 0;
    std::uint64_t voxels = 0;  // inside a leaf: those of the cell
    int level = 0;
};

std::optional<Cell> child_of(const Dag& dag, const Cell& cell, int child) {
    Cell next{0, 0, cell.level + 1};
    if (cell.level < dag.leaf_level()) {
        const std::uint32_t mask = dag.words()[cell.node];
        if (!(mask >> child & 1u)) return std::nullopt;
        next.node = dag.words()[cell.node + static_cast<unsigned>(child_offset(mask, child))];
        if (next.level == dag.leaf_level()) next.voxels = dag.leaf(next.node);
        return next;
    }
    const int voxels_of_child = cell.level == dag.leaf_level() ? 8 : 1;
    next.voxels =
        cell.voxels >> child * voxels_of_child & ((std::uint64_t{1} << voxels_of_child) - 1);
    if (next.voxels == 0) return std::nullopt;
    return next;
}

std::uint64_t count_cells(const Dag& dag, const Cell& cell, int level) {
    if (cell.level == level) return 1;
    std::uint64_t count = 0;
    for (int i = 0; i < 8; ++i)
        if (const auto child = child_of(dag, cell, i)) count += count_cells(dag, *child, level);
    return count;
}

}  // namespace

std::optional<std::uint64_t> find_cell_by_loop(const Dag& dag, int level, uvec3 cell) {
    std::uint32_t size = 1u << level;
    if (dag.empty() || cell.x >= size || cell.y >= size || cell.z >= size) return std::nullopt;
    Cell here;
    if (dag.leaf_level() == 0) here.voxels = dag.leaf(0);
    std::uint64_t passed = 0;
    while (size > 1) {
        const std::uint32_t half = size / 2;
        const uvec3 p(cell.x >= half, cell.y >= half, cell.z >= half);
        const int wanted = static_cast<int>(p.x + 2 * p.y + 4 * p.z);
        for (int i = 0; i < wanted; ++i)
            if (const auto sibling = child_of(dag, here, i))
                passed += count_cells(dag, *sibling, level);
        const auto child = child_of(dag, here, wanted);
        if (!child) return std::nullopt;
        here = *child;
        cell -= p * half;
        size = half;
    }
    return passed;
}

}  // namespace octavo
