// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octavo/construct/word_array.h"
#include "octavo/dag/node.h"

namespace octavo {

/// The different nodes of one level, each stored once, in the order in which they were first asked
/// for (hash-consing). A node is its words: a leaf's two halves, or a child mask and the ids of the
/// children. Its id is the index of its first word among the level's words.
///
/// Expected O(1) for each request. Memory: the words, and 7 to 13 bytes of table for each node.
class UniqueNodes {
public:
    enum class Kind { leaves, interior };

    explicit UniqueNodes(Kind kind) : kind_(kind) {}

    /// The id of the node with these words; adds it if it is new.
    /// @throws Error limit where an id would not fit 32 bits
    std::uint32_t add(const std::uint32_t* node) { return add(node, hash(node)); }
    std::uint32_t add(const std::uint32_t* node, std::uint64_t hash) {
        if (slots_.empty()) grow_table();
        const int size = size_of(node);
        for (std::size_t slot = home(hash);; slot = (slot + 1) & (slots_.size() - 1)) {
            const std::uint32_t id = slots_[slot];
            if (id == kEmpty) return append(node, size, slot);
            if (equal(words_.data() + id, node, size)) return id;
        }
    }

    /// Adds nodes that stand one after the other, all of them new, so that their ids go on where
    /// the others end. False where the words are no such nodes; some of them may then have been
    /// added.
    [[nodiscard]] bool extend(std::span<const std::uint32_t> nodes);

    [[nodiscard]] std::uint64_t hash(const std::uint32_t* node) const {
        std::uint64_t h = mix(node[0] | std::uint64_t{node[1]} << 32);
        if (kind_ == Kind::leaves) return h;
        const int size = node_words(node[0]);
        for (int i = 2; i < size; i += 2)
            h = mix(h ^ (node[i] | std::uint64_t{i + 1 < size ? node[i + 1] : 0} << 32));
        return h;
    }

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

    /// Memory that nodes and table take.
    [[nodiscard]] std::uint64_t memory_bytes() const {
        return (words_.size() + slots_.size()) * sizeof(std::uint32_t);
    }

    /// Memory that the table will take on top, if it is about to double.
    [[nodiscard]] std::uint64_t growth_bytes() const {
        const bool soon = count_ * 8 > slots_.size() * 4;  // it doubles at 5
        return soon ? slots_.size() * sizeof(std::uint32_t) : 0;
    }

    /// Forgets the nodes but keeps the memory, for the next nodes.
    void clear();

    /// Gives the memory of the table back; then nothing can be added any more.
    void drop_table() { slots_ = {}; }

    /// Gives the memory of the nodes before this id back; only later ones are still there.
    void discard_before(std::uint64_t id) { words_.discard_before(id); }

    /// Gives all memory back.
    void reset() { *this = UniqueNodes(kind_); }

private:
    static constexpr std::uint32_t kEmpty = 0xffffffffu;

    // Both halves of a product with an odd constant: every bit of x reaches every bit of the
    // result, for the price of one multiplication. A node is a few words, looked up billions of
    // times.
    static std::uint64_t mix(std::uint64_t x) {
        __extension__ typedef unsigned __int128 Wide;
        const Wide product = Wide{x ^ 0x9e3779b97f4a7c15u} * 0xd6e8feb86659fd93u;
        return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
    }

    [[nodiscard]] bool equal(const std::uint32_t* a, const std::uint32_t* b, int size) const {
        if (a[0] != b[0] || a[1] != b[1]) return false;
        for (int i = 2; i < size; ++i)
            if (a[i] != b[i]) return false;
        return true;
    }

    [[nodiscard]] std::size_t home(std::uint64_t hash) const { return hash & (slots_.size() - 1); }
    std::uint32_t append(const std::uint32_t* node, int size, std::size_t slot);
    void grow_table();

    Kind kind_;
    WordArray words_;
    std::vector<std::uint32_t> slots_;  // open addressing, linear probing; ids or kEmpty
    std::uint64_t count_ = 0;
};

}  // namespace octavo
