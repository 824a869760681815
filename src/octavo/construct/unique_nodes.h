// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "octavo/construct/word_array.h"
#include "octavo/construct/word_limits.h"
#include "octavo/core/huge_pages.h"
#include "octavo/core/prefetch.h"
#include "octavo/dag/node.h"

namespace octavo {

/// The ids of up to eight children, two to a word; zero where there is none. Like that nodes are
/// hashed and compared without a branch on how many children they have.
struct ChildIds {
    std::uint64_t pair[4];

    /// The first `count` of eight words.
    static ChildIds first_of(const std::uint32_t* ids, int count) {
        ChildIds children;
        std::memcpy(children.pair, ids, sizeof children.pair);
        children.keep(count);
        return children;
    }

    /// Forgets those after the first `count`.
    void keep(int count) {
        for (unsigned i = 0; i < 4; ++i) pair[i] &= kFirst[static_cast<unsigned>(count)][i];
    }

    friend bool operator==(const ChildIds& a, const ChildIds& b) {
        return ((a.pair[0] ^ b.pair[0]) | (a.pair[1] ^ b.pair[1]) | (a.pair[2] ^ b.pair[2]) |
                (a.pair[3] ^ b.pair[3])) == 0;
    }

private:
    static constexpr auto kFirst = [] {
        std::array<std::array<std::uint64_t, 4>, 9> masks{};
        for (unsigned count = 0; count <= 8; ++count)
            for (unsigned i = 0; i < count; ++i)
                masks[count][i / 2] |= std::uint64_t{0xffffffff} << 32 * (i % 2);
        return masks;
    }();
};

/// What a first look for a leaf tells.
struct Glance {
    std::uint32_t id;  // where it is seen
    bool seen;
};

/// The different nodes of one level, each stored once, in the order in which they were first asked
/// for (hash-consing). A node is its words: a leaf's two halves, or a child mask and the ids of the
/// children. Its id is the index of its first word among the level's words.
///
/// Expected O(1) for each request: one cache line of the table, and the node itself where there is
/// one. Memory: the words, and 7 to 14 bytes of table for each node.
class UniqueNodes {
public:
    enum class Kind { leaves, interior };

    explicit UniqueNodes(Kind kind, const WordLimits& limits = {}) : kind_(kind), limits_(limits) {}

    /// The id of the node with these words; adds it if it is new.
    /// @throws Error limit where there would be more words than ids can name
    std::uint32_t add(const std::uint32_t* node) {
        if (kind_ == Kind::leaves) return add_leaf(voxels_of(node));
        const ChildIds children = children_of(node);
        return add_interior(node[0], children, hash_interior(node[0], children));
    }

    /// The same of a leaf, and of an interior node whose children's ids begin at `ids`: eight words
    /// can be read there, whatever those after the last id hold.
    std::uint32_t add_leaf(std::uint64_t voxels) { return add_leaf(voxels, hash_leaf(voxels)); }
    std::uint32_t add_interior(std::uint32_t child_mask, const std::uint32_t* ids) {
        const ChildIds children =
            ChildIds::first_of(ids, std::popcount(child_mask & kChildMaskBits));
        return add_interior(child_mask, children, hash_interior(child_mask, children));
    }

    /// The same, hashed before.
    std::uint32_t add_leaf(std::uint64_t voxels, std::uint64_t hash) {
        if (buckets_.empty()) grow_table();
        const std::uint8_t tag = tag_of(hash);
        for (std::size_t at = home(hash);; at = next(at)) {
            Bucket& bucket = buckets_[at];
            for (unsigned like = bucket.with_tag(tag); like != 0; like &= like - 1) {
                const std::uint32_t id = bucket.ids[std::countr_zero(like)];
                if (voxels_of(words_.data() + id) == voxels) return id;
            }
            if (!bucket.full()) return append_leaf(voxels, bucket, tag);
        }
    }
    std::uint32_t add_interior(std::uint32_t child_mask, const ChildIds& children,
                               std::uint64_t hash) {
        if (buckets_.empty()) grow_table();
        const int count = std::popcount(child_mask & kChildMaskBits);
        const std::uint8_t tag = tag_of(hash);
        for (std::size_t at = home(hash);; at = next(at)) {
            Bucket& bucket = buckets_[at];
            for (unsigned like = bucket.with_tag(tag); like != 0; like &= like - 1) {
                const std::uint32_t id = bucket.ids[std::countr_zero(like)];
                const std::uint32_t* other = words_.data() + id;  // with slack after the last one
                if (ChildIds::first_of(other + 1, count) == children && other[0] == child_mask)
                    return id;
            }
            if (!bucket.full()) return append_interior(child_mask, children, bucket, tag);
        }
    }

    /// Looks at the one place where a leaf mostly is, without a branch on whether it is: so one
    /// that is there may go unseen, and is to be asked for by add_leaf().
    [[nodiscard]] Glance glance_leaf(std::uint64_t voxels, std::uint64_t hash) const {
        if (count_ == 0) return {0, false};
        const std::uint32_t id = likely_id(hash);
        return {id, voxels_of(words_.data() + id) == voxels};
    }

    /// Adds nodes that stand one after the other, all of them new, so that their ids go on where
    /// the others end. False where the words are no such nodes; some of them may then have been
    /// added.
    [[nodiscard]] bool extend(std::span<const std::uint32_t> nodes);

    /// Takes nodes that stand one after the other, all different, in place of those that it has.
    /// They are there to be read; before more are added, clear().
    void assign(std::span<const std::uint32_t> nodes);

    /// The same with the nodes of another level of this kind, which is left empty, to be added to.
    /// Nothing is copied: it gets the room of the nodes that were here.
    void take(UniqueNodes& other);

    [[nodiscard]] std::uint64_t hash(const std::uint32_t* node) const {
        return kind_ == Kind::leaves ? hash_leaf(voxels_of(node))
                                     : hash_interior(node[0], children_of(node));
    }
    static std::uint64_t hash_leaf(std::uint64_t voxels) {
        return mix(voxels ^ kKeys[0], kKeys[1]);
    }
    static std::uint64_t hash_interior(std::uint32_t child_mask, const ChildIds& children) {
        const std::uint64_t* pair = children.pair;
        return mix(pair[0] ^ child_mask * kKeys[0], pair[1] ^ kKeys[1]) +
               std::rotl(mix(pair[2] ^ kKeys[2], pair[3] ^ kKeys[3]), 29);
    }

    /// Starts to fetch what adding looks at first for a node with this hash.
    void prefetch_slot(std::uint64_t hash) const {
        if (!buckets_.empty()) prefetch_line(&buckets_[home(hash)]);
    }

    /// Starts to fetch what it looks at next; to be called when the slot has had time to arrive.
    void prefetch_node(std::uint64_t hash) const {
        if (buckets_.empty()) return;
        const std::uint32_t id = likely_id(hash);
        prefetch_line(words_.data() + id);
        prefetch_line(words_.data() + id + kMaxNodeWords - 1);  // may be another line
    }

    /// Words that a node takes.
    [[nodiscard]] int size_of(const std::uint32_t* node) const {
        return kind_ == Kind::leaves ? kLeafWords : node_words(node[0]);
    }

    /// After the last one, WordArray::kSlack words more can be read.
    [[nodiscard]] std::span<const std::uint32_t> words() const { return words_.words(); }
    [[nodiscard]] std::uint64_t count() const { return count_; }

    /// Ids at which the words can be cut, so that many threads can go through the nodes: one for
    /// every kPieceNodes of those that were added.
    [[nodiscard]] std::span<const std::uint32_t> cuts() const { return cuts_; }
    static constexpr std::uint64_t kPieceNodes = 1 << 15;

    /// Says how many nodes there may come to be, before there are any: the table begins large
    /// enough for nearly so many, or at 32 MB, so that it need not grow, or less often.
    void expect(std::uint64_t count);

    /// Memory that nodes and table take.
    [[nodiscard]] std::uint64_t memory_bytes() const {
        return words_.size() * sizeof(std::uint32_t) + buckets_.size() * sizeof(Bucket);
    }

    /// Memory that the table will take on top, if it is about to double.
    [[nodiscard]] std::uint64_t growth_bytes() const {
        const bool soon = count_ > buckets_.size() * (kNodesOfBucket - 2);
        return soon ? buckets_.size() * sizeof(Bucket) : 0;
    }

    /// Forgets the nodes but keeps the memory, for the next nodes.
    void clear();

    /// Gives the memory of the table back; then nothing can be added any more.
    void drop_table() { buckets_ = {}; }

    /// Gives the memory of the nodes before this id back; only later ones are still there.
    void discard_before(std::uint64_t id) { words_.discard_before(id); }

    /// Gives all memory back.
    void reset() { *this = UniqueNodes(kind_, limits_); }

private:
    /// A cache line of the table: ids, and a byte of each node's hash, so that nodes that are not
    /// the one looked for are hardly ever fetched to find that out.
    struct alignas(64) Bucket {
        static constexpr unsigned kSize = 12;

        std::uint32_t ids[kSize];
        std::uint8_t tags[16];  // 0: nothing there, nor after it; the last four are not used

        /// Bit i is set where the i-th has this tag.
        [[nodiscard]] unsigned with_tag(std::uint8_t tag) const {
#if defined(__SSE2__)
            const __m128i all = _mm_load_si128(reinterpret_cast<const __m128i*>(tags));
            const __m128i like = _mm_cmpeq_epi8(all, _mm_set1_epi8(static_cast<char>(tag)));
            return static_cast<unsigned>(_mm_movemask_epi8(like)) & ((1u << kSize) - 1);
#else
            unsigned like = 0;
            for (unsigned i = 0; i < kSize; ++i) like |= unsigned{tags[i] == tag} << i;
            return like;
#endif
        }
        [[nodiscard]] bool full() const {
            return tags[kSize - 1] != 0;
        }
        /// Not where it is full.
        void put(std::uint32_t id, std::uint8_t tag) {
            const auto at = static_cast<unsigned>(std::countr_zero(with_tag(0)));
            if (at >= kSize) __builtin_unreachable();
            ids[at] = id;
            tags[at] = tag;
        }
    };

    // On average, when the table grows: few buckets are full then.
    static constexpr std::size_t kNodesOfBucket = 9;

    static constexpr std::uint64_t kKeys[4] = {0x9e3779b97f4a7c15u, 0xd6e8feb86659fd93u,
                                               0xc2b2ae3d27d4eb4fu, 0xff51afd7ed558ccdu};

    // Both halves of a product: every bit of one factor reaches every bit of the result, for the
    // price of one multiplication. A node is a few words, looked up billions of times.
    static std::uint64_t mix(std::uint64_t a, std::uint64_t b) {
        __extension__ typedef unsigned __int128 Wide;
        const Wide product = Wide{a} * b;
        return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
    }

    static std::uint64_t voxels_of(const std::uint32_t* leaf) {
        std::uint64_t voxels = 0;
        std::memcpy(&voxels, leaf, sizeof voxels);
        return voxels;
    }

    /// Of a node after which nothing may be read.
    static ChildIds children_of(const std::uint32_t* node) {
        std::uint32_t ids[8] = {};
        const int count = std::popcount(node[0] & kChildMaskBits);
        std::memcpy(ids, node + 1, static_cast<unsigned>(count) * sizeof(std::uint32_t));
        return ChildIds::first_of(ids, count);
    }

    static std::uint8_t tag_of(std::uint64_t hash) {
        const auto tag = static_cast<std::uint8_t>(hash >> 56);
        return tag == 0 ? 1 : tag;
    }
    [[nodiscard]] std::size_t home(std::uint64_t hash) const {
        return hash & (buckets_.size() - 1);
    }
    [[nodiscard]] std::size_t next(std::size_t bucket) const {
        return (bucket + 1) & (buckets_.size() - 1);
    }
    /// The first id of the hash's bucket that has its tag; if none has, that of any node.
    [[nodiscard]] std::uint32_t likely_id(std::uint64_t hash) const {
        const Bucket& bucket = buckets_[home(hash)];
        constexpr unsigned kLast = 1u << (Bucket::kSize - 1);
        return bucket.ids[std::countr_zero(bucket.with_tag(tag_of(hash)) | kLast)];
    }
    std::uint32_t append_leaf(std::uint64_t voxels, Bucket& bucket, std::uint8_t tag);
    std::uint32_t append_interior(std::uint32_t child_mask, const ChildIds& children,
                                  Bucket& bucket, std::uint8_t tag);
    std::uint32_t take_appended(int size, Bucket& bucket, std::uint8_t tag);
    void grow_table();
    void stop();

    Kind kind_;
    WordLimits limits_;
    WordArray words_;
    // What finds its bucket full goes to the next.
    HugeVector<Bucket> buckets_;
    std::size_t first_buckets_ = 16;
    std::uint64_t count_ = 0;
    std::uint64_t next_stop_ = 0;  // how many nodes there will be when stop() has something to do
    std::vector<std::uint32_t> cuts_;
};

}  // namespace octavo
