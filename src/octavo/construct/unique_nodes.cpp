// SPDX-License-Identifier: MIT
// [K13] section 3 finds equal nodes by sorting a level. Looking each one up in a table of those
// seen so far finds the same nodes, and keeps them in the order in which the tree first meets them.
#include "octavo/construct/unique_nodes.h"

#include <algorithm>
#include <array>
#include <utility>

namespace octavo {

std::uint32_t UniqueNodes::append_leaf(std::uint64_t voxels, Bucket& bucket, std::uint8_t tag) {
    std::memcpy(words_.room(kLeafWords), &voxels, sizeof voxels);
    return take_appended(kLeafWords, bucket, tag);
}

std::uint32_t UniqueNodes::append_interior(std::uint32_t child_mask, const ChildIds& children,
                                           Bucket& bucket, std::uint8_t tag) {
    std::uint32_t* words = words_.room(kMaxNodeWords);
    words[0] = child_mask;
    std::memcpy(words + 1, children.pair, sizeof children.pair);
    return take_appended(node_words(child_mask), bucket, tag);
}

std::uint32_t UniqueNodes::take_appended(int size, Bucket& bucket, std::uint8_t tag) {
    const std::uint64_t id = words_.size();
    limits_.check_level(id + static_cast<unsigned>(size));
    words_.commit(size);
    bucket.put(static_cast<std::uint32_t>(id), tag);
    if (++count_ >= next_stop_) stop();
    return static_cast<std::uint32_t>(id);
}

// Both things that are to be done from time to time, so that a node that is added asks once.
void UniqueNodes::stop() {
    if (count_ % kPieceNodes == 0) cuts_.push_back(static_cast<std::uint32_t>(words_.size()));
    if (count_ > buckets_.size() * kNodesOfBucket) grow_table();
    next_stop_ =
        std::min(buckets_.size() * kNodesOfBucket + 1, (count_ / kPieceNodes + 1) * kPieceNodes);
}

void UniqueNodes::expect(std::uint64_t count) {
    // New pages are zeroed where the first nodes happen to fall: of a table of gigabytes that is
    // most of it during the first tile, which nobody can interrupt.
    constexpr std::uint64_t kMostBuckets = (std::uint64_t{32} << 20) / sizeof(Bucket);
    // What is expected may be a third too high without doubling a table that need not.
    const std::uint64_t buckets = std::min(kMostBuckets, count * 3 / 4 / kNodesOfBucket);
    first_buckets_ = std::bit_ceil(std::max<std::uint64_t>(first_buckets_, buckets));
}

bool UniqueNodes::extend(std::span<const std::uint32_t> nodes) {
    for (std::size_t i = 0; i < nodes.size();) {
        const auto size = static_cast<unsigned>(size_of(&nodes[i]));
        if (size < kLeafWords || size > nodes.size() - i) return false;
        const std::uint64_t id = words_.size();
        if (add(&nodes[i]) != id) return false;
        i += size;
    }
    return true;
}

void UniqueNodes::assign(std::span<const std::uint32_t> nodes) {
    clear();
    for (std::size_t i = 0; i < nodes.size(); ++count_) {
        const int size = size_of(&nodes[i]);
        words_.append(&nodes[i], size);
        i += static_cast<unsigned>(size);
    }
}

void UniqueNodes::take(UniqueNodes& other) {
    std::swap(words_, other.words_);
    std::swap(cuts_, other.cuts_);
    count_ = other.count_;
    other.clear();
}

void UniqueNodes::clear() {
    words_.clear();
    std::fill(buckets_.begin(), buckets_.end(), Bucket{});
    count_ = next_stop_ = 0;
    cuts_.clear();
}

void UniqueNodes::grow_table() {
    const std::size_t bucket_count = buckets_.empty() ? first_buckets_ : 2 * buckets_.size();
    buckets_ = {};  // first, so that the old table and the new one are never held together
    buckets_.resize(bucket_count);

    // Nodes wait in a ring after they have been hashed, until their bucket has come from memory.
    struct Waiting {
        std::uint64_t hash;
        std::uint32_t id;
    };
    std::array<Waiting, 32> ring;
    const auto put = [&](const Waiting& node) {
        std::size_t at = home(node.hash);
        while (buckets_[at].full()) at = next(at);
        buckets_[at].put(node.id, tag_of(node.hash));
    };
    std::uint64_t seen = 0;
    for (std::uint64_t id = 0; id < words_.size(); ++seen) {
        const std::uint32_t* node = words_.data() + id;  // with slack after the last one
        const int size = size_of(node);
        const std::uint64_t h =
            kind_ == Kind::leaves ? hash_leaf(voxels_of(node))
                                  : hash_interior(node[0], ChildIds::first_of(node + 1, size - 1));
        Waiting& place = ring[seen % ring.size()];
        if (seen >= ring.size()) put(place);
        place = {h, static_cast<std::uint32_t>(id)};
        prefetch_slot(h);
        id += static_cast<unsigned>(size);
    }
    for (std::uint64_t i = seen - std::min<std::uint64_t>(seen, ring.size()); i < seen; ++i)
        put(ring[i % ring.size()]);
}

}  // namespace octavo
