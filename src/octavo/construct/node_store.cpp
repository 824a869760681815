// SPDX-License-Identifier: MIT
// Source: [K13] section 3, "each subtree is reduced to a DAG before we insert it into the top".
#include "octavo/construct/node_store.h"

#include <array>
#include <string>
#include <utility>

#include "octavo/core/error.h"

namespace octavo {

namespace {

/// Copies a level's nodes and moves their pointers on to where the next level begins. What has been
/// copied is given back on the way, so that the DAG is not held twice.
void append_interior(UniqueNodes& nodes, std::uint32_t children_begin,
                     std::vector<std::uint32_t>& words) {
    constexpr std::uint64_t kDiscardEvery = 1 << 22;
    const std::span<const std::uint32_t> from = nodes.words();
    std::uint64_t next_discard = kDiscardEvery;
    for (std::uint64_t i = 0; i < from.size();) {
        const auto end = i + static_cast<unsigned>(nodes.size_of(from.data() + i));
        words.push_back(from[i]);
        while (++i < end) words.push_back(from[i] + children_begin);
        if (i >= next_discard) {
            nodes.discard_before(i);
            next_discard = i + kDiscardEvery;
        }
    }
}

}  // namespace

std::vector<std::uint64_t> level_begins(std::span<const std::uint64_t> level_words) {
    std::vector<std::uint64_t> begins = {0};
    for (const std::uint64_t words : level_words) begins.push_back(begins.back() + words);
    if (begins.back() > std::uint64_t{1} << 32)
        throw Error(Errc::limit, "the DAG needs " + std::to_string(begins.back()) +
                                     " words of 32 bits; at most 2^32 can be addressed");
    return begins;
}

NodeStore::NodeStore(int top) {
    levels_.emplace_back(UniqueNodes::Kind::leaves);
    for (int h = 1; h <= top; ++h) levels_.emplace_back(UniqueNodes::Kind::interior);
}

std::uint32_t NodeStore::merge_root(const NodeStore& part) {
    // The nodes of a level wait in a ring between being hashed and being added, so that the table's
    // slot and then the node it names arrive from memory meanwhile.
    constexpr std::uint64_t kRing = 32;
    constexpr std::uint64_t kNodeDelay = 16;
    struct Waiting {
        std::uint32_t words[kMaxNodeWords];
        std::uint32_t id;
        std::uint64_t hash;
    };
    std::array<Waiting, kRing> ring;

    std::uint32_t last_id = 0;
    for (int h = 0; h <= part.top(); ++h) {
        UniqueNodes& target = level(h);
        const UniqueNodes& nodes = part.level(h);
        const std::uint32_t* words = nodes.words().data();
        const std::uint64_t count = nodes.count();
        std::swap(new_ids_, new_ids_below_);
        new_ids_.resize(nodes.words().size());

        std::uint32_t id = 0;
        for (std::uint64_t i = 0; i < count + kRing; ++i) {
            if (i >= kRing) {
                const Waiting& node = ring[i % kRing];
                last_id = target.add(node.words, node.hash);
                new_ids_[node.id] = last_id;
            }
            if (i >= kNodeDelay && i - kNodeDelay < count)
                target.prefetch_node(ring[(i - kNodeDelay) % kRing].hash);
            if (i < count) {
                Waiting& node = ring[i % kRing];
                const std::uint32_t* old = words + id;
                const int size = nodes.size_of(old);
                node.words[0] = old[0];
                for (int k = 1; k < size; ++k)
                    node.words[k] = h == 0 ? old[k] : new_ids_below_[old[k]];
                node.id = id;
                node.hash = target.hash(node.words);
                target.prefetch_slot(node.hash);
                id += static_cast<unsigned>(size);
            }
        }
    }
    return last_id;
}

void NodeStore::clear() {
    for (UniqueNodes& level : levels_) level.clear();
}

void NodeStore::reset() {
    for (UniqueNodes& level : levels_) level.reset();
    new_ids_ = {};
    new_ids_below_ = {};
}

std::uint64_t NodeStore::memory_bytes() const {
    std::uint64_t bytes = 0;
    for (const UniqueNodes& level : levels_) bytes += level.memory_bytes();
    return bytes;
}

std::uint64_t NodeStore::growth_bytes() const {
    std::uint64_t bytes = 0;
    for (const UniqueNodes& level : levels_) bytes += level.growth_bytes();
    return bytes;
}

Dag NodeStore::freeze(int depth) && {
    for (UniqueNodes& level : levels_) level.drop_table();

    std::vector<std::uint64_t> level_words;
    for (int l = 0; l < depth - 1; ++l) level_words.push_back(level(depth - 2 - l).words().size());
    std::vector<std::uint64_t> begins = level_begins(level_words);
    const std::uint64_t total = begins.back();

    std::vector<std::uint32_t> words;
    words.reserve(total);
    for (int l = 0; l < depth - 1; ++l) {
        UniqueNodes& nodes = level(depth - 2 - l);
        if (l == depth - 2) {
            words.insert(words.end(), nodes.words().begin(), nodes.words().end());
        } else {
            append_interior(nodes, static_cast<std::uint32_t>(begins[static_cast<unsigned>(l) + 1]),
                            words);
        }
        nodes.reset();
    }
    return Dag(depth, std::move(begins), std::move(words));
}

}  // namespace octavo
