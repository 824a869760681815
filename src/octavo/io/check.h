// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace octavo {

/// What is wrong with an array of DAG words, and at which word.
struct DagFault {
    std::string_view code;  // as in Finding
    std::uint64_t word = 0;
    std::string reason;
    bool strict_only = false;  // the DAG can be read all the same
};

/// What is said of a DAG, to be compared with what it is. Empty: not compared.
struct DagClaims {
    std::span<const std::uint64_t> level_nodes = {};  // stored in each of the depth - 1 levels
    std::optional<std::uint64_t> voxels = {};
};

struct DagCheckOptions {
    /// Also what costs room and harms nothing: two equal nodes in a level, a node that nothing
    /// leads to, nodes in another order than docs/adr/0003-node-order.md says.
    bool strict = false;
    std::size_t max_faults = 1;
};

/// Is it safe to follow every pointer of these words, and do they hold what is claimed? That is:
/// level 0 is one node; every node has a child and no spare bit; every pointer leads to the first
/// word of a node of the next level; no leaf is empty; the nodes of each level fill it exactly; and
/// nodes and voxels are as many as stated. Without strict, nodes that nothing points to and nodes
/// that are equal are not faults: they cost room, but nothing goes wrong.
///
/// @param level_begins  depth entries as in Dag: begins of levels 0 to depth - 2, then the word
///                      count
/// @param words         any content
/// @return  up to max_faults faults, the same whatever the number of threads
///
/// Cost: visits every node once, never a path. Words that are sound cost one pass and a look-up for
/// each pointer, see voxels_if_sound; only where they are not, or strictly, a slower check says
/// what is wrong. Memory: half a byte to four for each word of two levels; then 1/16 of the words,
/// and eight bytes for each node of two levels. Strict: a sort of every level, and 16 bytes for
/// each of its nodes.
[[nodiscard]] std::vector<DagFault> find_faults(std::span<const std::uint64_t> level_begins,
                                                std::span<const std::uint32_t> words,
                                                const DagClaims& claims = {},
                                                const DagCheckOptions& options = {});

}  // namespace octavo
