// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace octavo {

/// What is wrong with an array of DAG words, and at which word.
struct DagFault {
    std::uint64_t word = 0;
    std::string reason;
};

/// Is it safe to follow every pointer of these words? That is: level 0 is one node; every node has
/// a child and no spare bit; every pointer leads to the first word of a node of the next level; no
/// leaf is empty; and the nodes of each level fill it exactly. Nodes that nothing points to, and
/// nodes that are equal, are not faults: they cost room, but nothing goes wrong.
///
/// @param level_begins  depth entries as in Dag: begins of levels 0 to depth - 2, then the word
/// count
/// @param words         any content
/// @param level_nodes   if given, the number of nodes in each of the depth - 1 levels; checked as
/// well
/// @return the first fault found, or nothing
///
/// Cost: visits every node once, never a path; a bit of memory per word of the largest interior
/// level.
[[nodiscard]] std::optional<DagFault> find_fault(std::span<const std::uint64_t> level_begins,
                                                 std::span<const std::uint32_t> words,
                                                 std::span<const std::uint64_t> level_nodes = {});

}  // namespace octavo
