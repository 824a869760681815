// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octavo/construct/word_array.h"
#include "octavo/dag/node.h"

namespace octavo {

/// The different nodes of one level, each stored once, in the order in which they were first asked for
/// (hash-consing). A node is its words: a leaf's two halves, or a child mask and the ids of the children.
/// Its id is the index of its first word among the level's words.
///
/// Expected O(1) for each request. Memory: the words, and 7 to 13 bytes of table for each node.
class UniqueNodes {
public:
    enum class Kind { leaves, interior };

    explicit UniqueNodes(Kind kind) : kind_(kind) {}

    /// The id of the node with these words; adds it if it is new.
    /// @throws Error limit where an id would not fit 32 bits
    std::uint32_t add(const std::uint32_t* node) { return add(node, hash(node)); }
    std::uint32_t add(const std::uint32_t* node, std::uint64_t hash);

    [[nodiscard]] std::uint64_t hash(const std::uint32_t* node) const;

    /// Starts to fetch what add() looks at first for a node with this hash.
    void prefetch_slot(std::uint64_t hash) const;

    /// Starts to fetch what it looks at next; to be called when the slot has had time to arrive.
    void prefetch_node(std::uint64_t hash) const;

    /// Words that a node takes.
    [[nodiscard]] int size_of(const std::uint32_t* node) const {
        return kind_ == Kind::leaves ? kLeafWords : node_words(node[0]);
    }

    [[nodiscard]] std::span<const std::uint32_t> words() const { return words_.words(); }
    [[nodiscard]] std::uint64_t count() const { return count_; }

    /// Forgets the nodes but keeps the memory, for the next nodes.
    void clear();

    /// Gives the memory of the table back; then nothing can be added any more.
    void drop_table() { slots_ = {}; }

    /// Gives all memory back.
    void reset() { *this = UniqueNodes(kind_); }

private:
    static constexpr std::uint32_t kEmpty = 0xffffffffu;

    [[nodiscard]] std::size_t home(std::uint64_t hash) const { return hash & (slots_.size() - 1); }
    void grow_table();

    Kind kind_;
    WordArray words_;
    std::vector<std::uint32_t> slots_;  // open addressing, linear probing; ids or kEmpty
    std::uint64_t count_ = 0;
};

}  // namespace octavo
