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

std::uint32_t UniqueNodes::append(const std::uint32_t* node, int size, std::size_t slot) {
    const std::uint64_t id = words_.size();
    if (id + static_cast<unsigned>(size) > kEmpty)
        throw Error(Errc::limit, "a level of the DAG needs more than 2^32 words");
    words_.append(node, size);
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

void UniqueNodes::prefetch_slot(std::uint64_t hash) const {
    if (!slots_.empty()) __builtin_prefetch(&slots_[home(hash)], 1);
}

void UniqueNodes::prefetch_node(std::uint64_t hash) const {
    if (slots_.empty()) return;
    const std::uint32_t id = slots_[home(hash)];
    if (id != kEmpty) __builtin_prefetch(words_.data() + id);
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
        const std::uint32_t* node = words_.data() + id;
        std::size_t slot = home(hash(node));
        while (slots_[slot] != kEmpty) slot = (slot + 1) & (slots_.size() - 1);
        slots_[slot] = static_cast<std::uint32_t>(id);
        id += static_cast<unsigned>(size_of(node));
    }
}

}  // namespace octavo
