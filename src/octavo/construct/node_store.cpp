// SPDX-License-Identifier: MIT
// Source: [K13] section 3, "each subtree is reduced to a DAG before we insert it into the top".
#include "octavo/construct/node_store.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>

namespace octavo {

namespace {

// What has been copied is given back after so many words, so that the DAG is not held twice.
constexpr std::uint64_t kDiscardEvery = 1 << 22;

/// Copies nodes and moves their pointers on to where the next level begins.
void copy_interior(std::span<const std::uint32_t> nodes, std::uint32_t children_begin,
                   std::uint32_t* out) {
    std::size_t i = 0;
    while (i + kMaxNodeWords <= nodes.size()) {
        const std::uint32_t* node = nodes.data() + i;
        out[i] = node[0];
        // Always eight, without a branch; the next node overwrites what is too much.
        for (int k = 1; k < kMaxNodeWords; ++k) out[i + k] = node[k] + children_begin;
        i += static_cast<unsigned>(node_words(node[0]));
    }
    while (i < nodes.size()) {  // after the last one there may be what another thread has copied
        const std::uint32_t* node = nodes.data() + i;
        const int size = node_words(node[0]);
        out[i] = node[0];
        for (int k = 1; k < size; ++k) out[i + k] = node[k] + children_begin;
        i += static_cast<unsigned>(size);
    }
}

/// Where to cut a level for the threads: its begin, its end, and nodes between them.
std::vector<std::uint64_t> cuts_of(const UniqueNodes& nodes, bool leaves) {
    const std::uint64_t size = nodes.words().size();
    std::vector<std::uint64_t> cuts = {0};
    if (leaves) {
        constexpr std::uint64_t kPiece = kLeafWords * UniqueNodes::kPieceNodes;
        while (size - cuts.back() > kPiece) cuts.push_back(cuts.back() + kPiece);
    } else {
        cuts.insert(cuts.end(), nodes.cuts().begin(), nodes.cuts().end());
    }
    if (cuts.back() != size) cuts.push_back(size);
    return cuts;
}

/// Copies a level to where it belongs in the DAG, by all threads, and gives its memory back.
/// @param children_begin  where the next level begins; none: these are leaves
void move_level(UniqueNodes& nodes, std::optional<std::uint32_t> children_begin,
                std::uint32_t* out) {
    const std::vector<std::uint64_t> cuts = cuts_of(nodes, !children_begin);
    for (std::size_t first = 0; first + 1 < cuts.size();) {
        std::size_t last = first + 1;
        while (last + 1 < cuts.size() && cuts[last] - cuts[first] < kDiscardEvery) ++last;
        tbb::parallel_for(first, last, [&](std::size_t piece) {
            const std::span from =
                nodes.words().subspan(cuts[piece], cuts[piece + 1] - cuts[piece]);
            if (children_begin) {
                copy_interior(from, *children_begin, out + cuts[piece]);
            } else {
                std::ranges::copy(from, out + cuts[piece]);
            }
        });
        nodes.discard_before(cuts[last]);
        first = last;
    }
    nodes.reset();
}

}  // namespace

std::vector<std::uint64_t> level_begins(std::span<const std::uint64_t> level_words,
                                        const WordLimits& limits) {
    std::vector<std::uint64_t> begins = {0};
    for (const std::uint64_t words : level_words) begins.push_back(begins.back() + words);
    limits.check_dag(begins.back());
    return begins;
}

NodeStore::NodeStore(int top, const WordLimits& limits) : limits_(limits) {
    levels_.emplace_back(UniqueNodes::Kind::leaves, limits);
    for (int h = 1; h <= top; ++h) levels_.emplace_back(UniqueNodes::Kind::interior, limits);
}

void NodeStore::expect(std::span<const std::uint64_t> level_nodes) {
    const std::size_t heights = std::min(level_nodes.size(), levels_.size());
    for (std::size_t h = 0; h < heights; ++h)
        levels_[h].expect(level_nodes[level_nodes.size() - 1 - h]);
}

// The nodes of a level wait in a ring between being hashed and being added, so that the table's
// slot and then the node it names arrive from memory meanwhile.
namespace {

constexpr std::uint64_t kRing = 32;
constexpr std::uint64_t kNodeDelay = 16;

/// Calls begin(i), look(i) and add(i) for each i below count: in that order for each, and all calls
/// of one kind in order, but with others between them.
template <class Begin, class Look, class Add>
void in_a_ring(std::uint64_t count, const Begin& begin, const Look& look, const Add& add) {
    for (std::uint64_t i = 0; i < count + kRing; ++i) {
        if (i >= kRing) add(i - kRing);
        if (i >= kNodeDelay && i - kNodeDelay < count) look(i - kNodeDelay);
        if (i < count) begin(i);
    }
}

}  // namespace

std::uint32_t NodeStore::merge_leaves(const UniqueNodes& leaves) {
    UniqueNodes& target = level(0);
    std::array<std::uint64_t, kRing> hashes;
    const std::uint32_t* words = leaves.words().data();
    new_ids_.resize(leaves.words().size());
    std::uint32_t last_id = 0;
    const auto voxels = [&](std::uint64_t i) {
        return words[2 * i] | std::uint64_t{words[2 * i + 1]} << 32;
    };
    in_a_ring(
        leaves.count(),
        [&](std::uint64_t i) {
            hashes[i % kRing] = UniqueNodes::hash_leaf(voxels(i));
            target.prefetch_slot(hashes[i % kRing]);
        },
        [&](std::uint64_t i) { target.prefetch_node(hashes[i % kRing]); },
        [&](std::uint64_t i) {
            last_id = target.add_leaf(voxels(i), hashes[i % kRing]);
            new_ids_[2 * i] = last_id;
        });
    return last_id;
}

std::uint32_t NodeStore::merge_level(const UniqueNodes& nodes, UniqueNodes& target) {
    struct Waiting {
        ChildIds children;
        std::uint64_t hash;
        std::uint32_t child_mask, id;
    };
    std::array<Waiting, kRing> ring;
    const std::uint32_t* words = nodes.words().data();
    std::swap(new_ids_, new_ids_below_);
    new_ids_.resize(nodes.words().size());
    std::uint32_t next = 0, last_id = 0;
    in_a_ring(
        nodes.count(),
        [&](std::uint64_t i) {
            Waiting& node = ring[i % kRing];
            const std::uint32_t* old = words + next;
            const int count = node_words(old[0]) - 1;
            const ChildIds old_children = ChildIds::first_of(old + 1, count);
            // Those after the last one look up 0, and are dropped.
            for (int k = 0; k < 4; ++k) {
                const std::uint64_t pair = old_children.pair[k];
                const std::uint64_t high = new_ids_below_[pair >> 32];
                node.children.pair[k] =
                    new_ids_below_[static_cast<std::uint32_t>(pair)] | high << 32;
            }
            node.children.keep(count);
            node.child_mask = old[0];
            node.id = next;
            node.hash = UniqueNodes::hash_interior(node.child_mask, node.children);
            target.prefetch_slot(node.hash);
            next += static_cast<unsigned>(count) + 1;
        },
        [&](std::uint64_t i) { target.prefetch_node(ring[i % kRing].hash); },
        [&](std::uint64_t i) {
            const Waiting& node = ring[i % kRing];
            last_id = target.add_interior(node.child_mask, node.children, node.hash);
            new_ids_[node.id] = last_id;
        });
    return last_id;
}

std::uint32_t NodeStore::merge_root(const NodeStore& part) {
    std::uint32_t last_id = merge_leaves(part.level(0));
    for (int h = 1; h <= part.top(); ++h) last_id = merge_level(part.level(h), level(h));
    return last_id;
}

std::uint32_t NodeStore::merge_root(const NodeStore& part,
                                    const std::function<void(int height, std::uint32_t id)>& met) {
    std::uint32_t last_id = 0;
    for (int h = 0; h <= part.top(); ++h) {
        const UniqueNodes& nodes = part.level(h);
        last_id = h == 0 ? merge_leaves(nodes) : merge_level(nodes, level(h));
        const std::span<const std::uint32_t> words = nodes.words();
        for (std::size_t id = 0; id < words.size();
             id += static_cast<unsigned>(nodes.size_of(&words[id])))
            met(h, new_ids_[id]);
    }
    return last_id;
}

void NodeStore::take(NodeStore& other) {
    for (int h = 0; h <= top(); ++h) level(h).take(other.level(h));
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
    std::vector<std::uint64_t> begins = level_begins(level_words, limits_);
    const std::uint64_t total = begins.back();

    const auto words = std::make_shared<HugeVector<std::uint32_t>>(total);
    for (int l = 0; l < depth - 1; ++l) {
        std::optional<std::uint32_t> children_begin;
        if (l < depth - 2)
            children_begin = static_cast<std::uint32_t>(begins[static_cast<unsigned>(l) + 1]);
        move_level(level(depth - 2 - l), children_begin,
                   words->data() + begins[static_cast<unsigned>(l)]);
    }
    return Dag(depth, std::move(begins), std::span(words->data(), total), words);
}

}  // namespace octavo
