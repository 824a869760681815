// SPDX-License-Identifier: MIT
// Source: [B18], voxel attributes by counting; [K13] section 5.3 for attributes beside the DAG.
#include "octavo/attributes/cell_index.h"

#include <algorithm>
#include <string>

#include "octavo/core/error.h"

namespace octavo {

CellIndex::CellIndex(const Dag& dag, int level) : dag_(dag), level_(level) {
    if (level < kMinDepth || level > dag.depth())
        throw Error(Errc::bad_argument, "level " + std::to_string(level) +
                                            " is not one of 2 to the depth of the DAG, " +
                                            std::to_string(dag.depth()));
    bottom_ = std::min(level - 1, dag.leaf_level());
    if (dag.empty()) return;

    low_.resize(dag.level_begin(bottom_));
    const auto cells_below = [&](std::uint64_t node, int node_level) -> std::uint64_t {
        return node_level == bottom_ ? static_cast<unsigned>(std::popcount(bottom_mask(node)))
                                     : sum(node);
    };
    for (int l = bottom_ - 1; l >= 0; --l) {
        const std::uint64_t end = dag.level_begin(l + 1);
        for (std::uint64_t node = dag.level_begin(l); node < end;) {
            const auto size = static_cast<unsigned>(node_words(dag.words()[node]));
            std::uint64_t cells = 0;
            const auto store = [&](std::uint64_t word) {
                low_[word] = static_cast<std::uint32_t>(cells);
                // A node holds no more than the one above it, so once a level needs the high
                // halves all levels above it do.
                if (cells >> 32 != 0 && high_.empty()) high_.resize(end);
                if (word < high_.size()) high_[word] = static_cast<std::uint32_t>(cells >> 32);
            };
            for (unsigned i = 1; i < size; ++i) {
                store(node + i);
                cells += cells_below(dag.words()[node + i], l + 1);
            }
            store(node);
            node += size;
        }
    }
    count_ = cells_below(0, 0);
}

std::optional<std::uint64_t> CellIndex::find(const uvec3& cell) const {
    const CellRange range = cells_in(cell, level_);
    if (range.empty()) return std::nullopt;
    return range.begin;
}

CellRange CellIndex::cells_in(const uvec3& cell, int level) const {
    const std::uint32_t side = 1u << level;
    if (dag_.empty() || cell.x >= side || cell.y >= side || cell.z >= side) return {};

    const std::uint64_t code = morton_encode(cell);
    std::uint64_t node = 0;
    CellRange range{0, count_};
    for (int l = 0; l < std::min(level, bottom_); ++l) {
        const int child = static_cast<int>(code >> 3 * (level - 1 - l) & 7u);
        const std::uint32_t mask = dag_.words()[node];
        if (!(mask >> child & 1u)) return {};
        const std::uint64_t word = node + static_cast<unsigned>(child_offset(mask, child));
        const bool last = (mask & kChildMaskBits) >> child == 1u;
        const std::uint64_t first = range.begin;
        if (!last) range.end = first + sum(word + 1);
        range.begin = first + sum(word);
        node = dag_.words()[word];
    }
    if (level <= bottom_) return range;

    // The cell is a run of bits in the last node's mask: one, or eight where the node is a leaf and
    // the cell half as wide.
    const std::uint64_t cells = bottom_mask(node);
    const int bits = 3 * (level_ - level);
    const std::uint64_t in_node = code & ((std::uint64_t{1} << 3 * (level - bottom_)) - 1);
    const std::uint64_t first_bit = in_node << bits;
    const std::uint64_t run = (std::uint64_t{1} << (1 << bits)) - 1;
    range.begin +=
        static_cast<unsigned>(std::popcount(cells & ((std::uint64_t{1} << first_bit) - 1)));
    range.end = range.begin + static_cast<unsigned>(std::popcount(cells >> first_bit & run));
    if (range.empty()) return {};
    return range;
}

uvec3 CellIndex::cell(std::uint64_t index) const {
    uvec3 found(0);
    for_each({index, index + 1}, [&](std::uint64_t, const uvec3& cell) { found = cell; });
    return found;
}

}  // namespace octavo
