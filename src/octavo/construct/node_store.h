// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "octavo/construct/unique_nodes.h"
#include "octavo/dag/dag.h"

namespace octavo {

/// A DAG that still grows: the unique nodes of every level up to some height.
///
/// Levels are counted from below here, because a part of the scene knows its leaves and not the
/// root: height 0 are the 4x4x4 leaves, a node of height h is 2^(h + 2) voxels wide, and a grid of
/// depth d has its root at height d - 2.
class NodeStore {
public:
    /// @param top  the greatest height that nodes will have
    explicit NodeStore(int top, const WordLimits& limits = {});

    [[nodiscard]] int top() const { return static_cast<int>(levels_.size()) - 1; }
    [[nodiscard]] UniqueNodes& level(int height) { return levels_[static_cast<unsigned>(height)]; }
    [[nodiscard]] const UniqueNodes& level(int height) const {
        return levels_[static_cast<unsigned>(height)];
    }

    /// Says how many nodes each level may come to have, the root's first; see
    /// UniqueNodes::expect().
    void expect(std::span<const std::uint64_t> level_nodes);

    /// Adds all nodes of a smaller store whose heights this one has too. Afterwards, node `id` of
    /// height h of `part` is node new_id(h, id) here.
    ///
    /// Equal parts merged in the same order give equal stores, and a node that is new is appended:
    /// so parts merged in Morton order leave every level in the order of the whole tree.
    /// @return  the id here of the single node that `part` has at its top
    std::uint32_t merge_root(const NodeStore& part);

    /// The same, and says for each node of the part its height and its id here.
    std::uint32_t merge_root(const NodeStore& part,
                             const std::function<void(int height, std::uint32_t id)>& met);

    /// Takes the nodes of a store of the same height in place of its own: to be merged from, not to
    /// be added to. The other one is left empty and keeps its tables.
    void take(NodeStore& other);

    /// Forgets all nodes, keeps the memory.
    void clear();

    /// Forgets all nodes and gives the memory back.
    void reset();

    [[nodiscard]] std::uint64_t memory_bytes() const;
    /// That tables will take on top which are about to grow.
    [[nodiscard]] std::uint64_t growth_bytes() const;

    /// The finished DAG. The store is consumed.
    /// @param depth  the grid's; the store's top level, depth - 2, holds the root or nothing
    /// @throws Error limit where the DAG has more words than pointers can name
    [[nodiscard]] Dag freeze(int depth) &&;

private:
    std::uint32_t merge_leaves(const UniqueNodes& leaves);
    std::uint32_t merge_level(const UniqueNodes& nodes, UniqueNodes& target);

    WordLimits limits_;
    std::vector<UniqueNodes> levels_;
    std::vector<std::uint32_t> new_ids_, new_ids_below_;  // scratch of merge_root
};

/// Where the levels of a DAG begin, as Dag wants it, the root's first.
/// @throws Error limit where they have more words together than pointers can name
[[nodiscard]] std::vector<std::uint64_t> level_begins(std::span<const std::uint64_t> level_words,
                                                      const WordLimits& limits = {});

}  // namespace octavo
