// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "octavo/core/morton.h"
#include "octavo/core/vec.h"
#include "octavo/dag/dag.h"

namespace octavo {

/// Occupied cells, counted from 0 in depth-first order: `begin` to before `end`.
struct CellRange {
    std::uint64_t begin = 0;
    std::uint64_t end = 0;

    [[nodiscard]] bool empty() const { return begin == end; }
    [[nodiscard]] std::uint64_t size() const { return end - begin; }
    friend bool operator==(const CellRange&, const CellRange&) = default;
};

/// Numbers the occupied cells of one level of a DAG in depth-first order, which is Morton order: so
/// that an array can say something of each cell while equal subtrees stay shared.
///
/// A cell of level M is occupied when it holds a voxel; at level depth, when it is one. The number
/// of a cell is the sum, along its path, of the cells beneath the siblings passed ([B18]). Those
/// sums stand in an array beside the words of the DAG: at a pointer's word, the cells beneath the
/// pointers before it in the same node; at a node's mask, the cells beneath the node. It covers the
/// levels above the last node of a path only, whose cells are the bits of a mask.
///
/// Memory: 4 bytes for each word of the levels above M - 1, and 4 more for those near the root
/// whose sums pass 2^32. Copies share the DAG's words and copy the sums.
class CellIndex {
public:
    /// Of an empty grid.
    CellIndex() = default;

    /// Cost: one pass over the nodes above level M, never over paths.
    /// @param level    M: 2 to dag.depth()
    /// @throws Error   bad_argument where the level is out of range
    CellIndex(const Dag& dag, int level);

    [[nodiscard]] int level() const { return level_; }
    [[nodiscard]] std::uint64_t count() const { return count_; }
    [[nodiscard]] const Dag& dag() const { return dag_; }

    /// The number of a cell; none where it is empty or outside the grid. Cost: a step per level.
    /// @param cell  integer coordinates at level()
    [[nodiscard]] std::optional<std::uint64_t> find(const uvec3& cell) const;

    /// The cells inside a cell of this or a coarser level; an empty range where there are none.
    /// @param level  0 to level()
    [[nodiscard]] CellRange cells_in(const uvec3& cell, int level) const;

    /// Where the cell with this number is: the inverse of find(). Cost: eight steps per level.
    /// @param index  below count()
    [[nodiscard]] uvec3 cell(std::uint64_t index) const;

    /// Calls visit(index, cell) for each cell of the range, in order. Parts of a range can be
    /// visited by different threads. Cost: that of cell(range.begin), and the cells themselves.
    template <class Visit>
    void for_each(CellRange range, const Visit& visit) const {
        for_each_code(range, [&](std::uint64_t index, std::uint64_t code) {
            visit(index, morton_decode(code));
        });
    }
    /// The same with the cell's Morton code.
    template <class Visit>
    void for_each_code(CellRange range, const Visit& visit) const {
        if (range.begin < range.end && !dag_.empty()) visit_node(0, 0, 0, 0, range, visit);
    }

    /// The array of sums, modulo 2^32, as a GPU reads it with attributes/cell_rank.h; the numbers
    /// are whole where fits_32_bits().
    [[nodiscard]] std::span<const std::uint32_t> sums() const { return low_; }
    [[nodiscard]] bool fits_32_bits() const { return count_ < 0xffffffffu; }

private:
    [[nodiscard]] std::uint64_t sum(std::uint64_t word) const {
        const std::uint64_t high = word < high_.size() ? high_[word] : 0;
        return low_[word] | high << 32;
    }

    /// The cells of a node of bottom_: bits in Morton order.
    [[nodiscard]] std::uint64_t bottom_mask(std::uint64_t node) const {
        if (level_ == dag_.depth()) return dag_.leaf(node);
        if (level_ == dag_.depth() - 1) return leaf_child_mask(dag_.leaf(node));
        return dag_.words()[node] & kChildMaskBits;
    }

    template <class Visit>
    void visit_node(std::uint64_t node, int level, std::uint64_t code, std::uint64_t first,
                    const CellRange& range, const Visit& visit) const {
        if (level == bottom_) {
            const int bits = 3 * (level_ - bottom_);
            for (std::uint64_t cells = bottom_mask(node); cells != 0; cells &= cells - 1, ++first)
                if (first >= range.begin && first < range.end)
                    visit(first, code << bits | static_cast<unsigned>(std::countr_zero(cells)));
            return;
        }
        std::uint32_t children = dag_.words()[node] & kChildMaskBits;
        const std::uint64_t node_end = first + sum(node);
        for (std::uint64_t word = node + 1; children != 0; ++word, children &= children - 1) {
            const std::uint64_t begin = first + sum(word);
            const bool last = (children & (children - 1)) == 0;
            const std::uint64_t end = last ? node_end : first + sum(word + 1);
            if (begin < range.end && end > range.begin)
                visit_node(dag_.words()[word], level + 1,
                           code << 3 | static_cast<unsigned>(std::countr_zero(children)), begin,
                           range, visit);
        }
    }

    Dag dag_;
    int level_ = kMinDepth;
    int bottom_ = 0;  // level of the last node of a path
    std::uint64_t count_ = 0;
    std::vector<std::uint32_t> low_;
    std::vector<std::uint32_t> high_;  // of the first levels, as far as any sum there needs it
};

}  // namespace octavo
