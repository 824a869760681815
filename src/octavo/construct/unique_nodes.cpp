// SPDX-License-Identifier: MIT
// [K13] section 3 finds equal nodes by sorting a level. Looking each one up in a table of those
// seen so far finds the same nodes, and keeps them in the order in which the tree first meets them.
#include "octavo/construct/unique_nodes.h"

#include <algorithm>

#include "octavo/core/error.h"

namespace octavo {
namespace {

constexpr std::size_t kFirstSlots = 256;

}  // namespace

std::uint32_t UniqueNodes::append_leaf(std::uint64_t voxels, std::size_t slot) {
    std::memcpy(words_.room(kLeafWords), &voxels, sizeof voxels);
    return take_appended(kLeafWords, slot);
}

std::uint32_t UniqueNodes::append_interior(std::uint32_t child_mask, const ChildIds& children,
                                           std::size_t slot) {
    std::uint32_t* words = words_.room(kMaxNodeWords);
    words[0] = child_mask;
    std::memcpy(words + 1, children.pair, sizeof children.pair);
    return take_appended(node_words(child_mask), slot);
}

std::uint32_t UniqueNodes::take_appended(int size, std::size_t slot) {
    const std::uint64_t id = words_.size();
    if (id + static_cast<unsigned>(size) > kEmpty)
        throw Error(Errc::limit, "a level of the DAG needs more than 2^32 words");
    words_.commit(size);
    slots_[slot] = static_cast<std::uint32_t>(id);
    // At most 5/8 full: linear probing then looks at two slots on average.
    if (++count_ * 8 > slots_.size() * 5) grow_table();
    return static_cast<std::uint32_t>(id);
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

void UniqueNodes::clear() {
    words_.clear();
    std::fill(slots_.begin(), slots_.end(), kEmpty);
    count_ = 0;
}

void UniqueNodes::grow_table() {
    const std::size_t slot_count = slots_.empty() ? kFirstSlots : 2 * slots_.size();
    slots_ = {};  // first, so that the old table and the new one are never held together
    slots_.assign(slot_count, kEmpty);
    for (std::uint64_t id = 0; id < words_.size();) {
        const std::uint32_t* node = words_.data() + id;  // with slack after the last one
        const int size = size_of(node);
        const std::uint64_t h =
            kind_ == Kind::leaves ? hash_leaf(voxels_of(node))
                                  : hash_interior(node[0], ChildIds::first_of(node + 1, size - 1));
        std::size_t slot = home(h);
        while (slots_[slot] != kEmpty) slot = next(slot);
        slots_[slot] = static_cast<std::uint32_t>(id);
        id += static_cast<unsigned>(size);
    }
}

}  // namespace octavo
