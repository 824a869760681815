// SPDX-License-Identifier: MIT
#include "octavo/io/check.h"

#include <utility>

#include "octavo/core/grid.h"
#include "octavo/dag/node.h"

namespace octavo {
namespace {

/// Words of the levels, as [begin, end) ranges of one level each.
struct Level {
    std::uint64_t begin = 0;
    std::uint64_t end = 0;

    [[nodiscard]] std::uint64_t size() const { return end - begin; }
    [[nodiscard]] bool holds(std::uint64_t word) const { return word >= begin && word < end; }
};

std::optional<DagFault> begins_fault(std::span<const std::uint64_t> begins, std::uint64_t words) {
    if (begins.size() < kMinDepth || begins.size() > kMaxDepth)
        return DagFault{0, "the number of levels is not in 2 to 17"};
    if (begins.front() != 0) return DagFault{0, "level 0 does not begin at word 0"};
    for (std::size_t i = 1; i < begins.size(); ++i)
        if (begins[i] < begins[i - 1])
            return DagFault{begins[i],
                            "level " + std::to_string(i) + " begins before the one above"};
    if (begins.back() != words)
        return DagFault{begins.back(), "the levels do not end where the words do"};
    if (words > std::uint64_t{1} << 32) return DagFault{0, "more than 2^32 words"};
    return std::nullopt;
}

/// Finds where the nodes of an interior level begin; one bit for each of its words.
std::optional<DagFault> mark_nodes(std::span<const std::uint32_t> words, const Level& level,
                                   std::vector<bool>& starts, std::uint64_t& count) {
    starts.assign(level.size(), false);
    count = 0;
    for (std::uint64_t node = level.begin; node < level.end; ++count) {
        const std::uint32_t mask = words[node];
        if (mask & ~kChildMaskBits) return DagFault{node, "spare bits of a node are not zero"};
        if (mask == 0) return DagFault{node, "a node without children"};
        starts[node - level.begin] = true;
        const auto size = static_cast<std::uint64_t>(node_words(mask));
        if (size > level.end - node)
            return DagFault{node, "a node reaches past the end of its level"};
        node += size;
    }
    return std::nullopt;
}

std::optional<DagFault> leaves_fault(std::span<const std::uint32_t> words, const Level& leaves) {
    if (leaves.size() % kLeafWords != 0)
        return DagFault{leaves.begin, "the leaf level has an odd number of words"};
    for (std::uint64_t leaf = leaves.begin; leaf < leaves.end; leaf += kLeafWords)
        if ((words[leaf] | words[leaf + 1]) == 0) return DagFault{leaf, "a leaf without voxels"};
    return std::nullopt;
}

/// Checks the pointers of one level. `is_node(word)`: does a node of `next` begin at this word?
template <typename IsNode>
std::optional<DagFault> pointers_fault(std::span<const std::uint32_t> words, const Level& level,
                                       const Level& next, const IsNode& is_node) {
    for (std::uint64_t node = level.begin; node < level.end;) {
        const std::uint64_t end = node + static_cast<std::uint64_t>(node_words(words[node]));
        for (std::uint64_t word = node + 1; word < end; ++word) {
            if (!next.holds(words[word]))
                return DagFault{word, "pointer " + std::to_string(words[word]) +
                                          " leads outside the next level"};
            if (!is_node(words[word]))
                return DagFault{word, "pointer " + std::to_string(words[word]) +
                                          " leads into the middle of a node"};
        }
        node = end;
    }
    return std::nullopt;
}

DagFault count_fault(std::uint64_t word, std::size_t level, std::uint64_t found,
                     std::uint64_t stated) {
    return {word, "level " + std::to_string(level) + " has " + std::to_string(found) +
                      " nodes where " + std::to_string(stated) + " are stated"};
}

}  // namespace

std::optional<DagFault> find_fault(std::span<const std::uint64_t> level_begins,
                                   std::span<const std::uint32_t> words,
                                   std::span<const std::uint64_t> level_nodes) {
    if (auto fault = begins_fault(level_begins, words.size())) return fault;
    if (words.empty()) return std::nullopt;

    const std::size_t leaf_level = level_begins.size() - 2;
    const auto range = [&](std::size_t level) {
        return Level{level_begins[level], level_begins[level + 1]};
    };
    const Level leaves = range(leaf_level);
    if (auto fault = leaves_fault(words, leaves)) return fault;

    const auto stated = [&](std::size_t level, std::uint64_t found) {
        return level_nodes.empty() || level_nodes[level] == found;
    };
    std::uint64_t count = leaves.size() / kLeafWords;
    if (!stated(leaf_level, count))
        return count_fault(leaves.begin, leaf_level, count, level_nodes[leaf_level]);

    // Upwards: the node starts of a level must be known before the pointers of the one above it.
    std::vector<bool> starts;
    std::vector<bool> next_starts;
    for (std::size_t level = leaf_level; level-- > 0;) {
        if (auto fault = mark_nodes(words, range(level), starts, count)) return fault;
        if (!stated(level, count))
            return count_fault(level_begins[level], level, count, level_nodes[level]);

        const Level next = range(level + 1);
        auto fault = level + 1 == leaf_level
                         ? pointers_fault(words, range(level), next,
                                          [&](std::uint64_t word) {
                                              return (word - next.begin) % kLeafWords == 0;
                                          })
                         : pointers_fault(words, range(level), next, [&](std::uint64_t word) {
                               return next_starts[word - next.begin];
                           });
        if (fault) return fault;
        std::swap(starts, next_starts);
    }
    if (count != 1) return DagFault{0, "level 0 is not a single node"};
    return std::nullopt;
}

}  // namespace octavo
