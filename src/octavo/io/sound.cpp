// SPDX-License-Identifier: MIT
#include "octavo/io/sound.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <memory>

#include "octavo/dag/node.h"
#include "octavo/io/mapped_file.h"
#include "octavo/io/node_starts.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octavo/io/sound.cpp"
#include <hwy/foreach_target.h>
// Must follow foreach_target.h.
#include <hwy/highway.h>

#ifndef OCTAVO_IO_SOUND_TYPES
#define OCTAVO_IO_SOUND_TYPES
namespace octavo {

/// Words that are classified at once: as many as there are bits in a word of starts.
inline constexpr std::uint64_t kGroup = 64;

/// Every node takes two words or more, so at most one begins in each pair of words of a level. For
/// each pair: 0 where none does; else the voxels below the node, times two, and 1 where it begins
/// at the second word. A look-up so tells both whether a pointer leads to a node and what is in it.
struct PairTable {
    std::shared_ptr<Mapping> memory;
    int entry_bytes = 0;  // 1, 2, 4 or 8

    template <typename Entry>
    [[nodiscard]] Entry* entries() const {
        return reinterpret_cast<Entry*>(memory->writable_bytes().data());
    }
    /// That of one pair, whatever the entries' width.
    [[nodiscard]] std::uint64_t entry(std::uint64_t pair) const {
        switch (entry_bytes) {
            case 1:
                return entries<std::uint8_t>()[pair];
            case 2:
                return entries<std::uint16_t>()[pair];
            case 4:
                return entries<std::uint32_t>()[pair];
            default:
                return entries<std::uint64_t>()[pair];
        }
    }
};

struct Group {
    std::array<std::uint32_t, kGroup> voxels;  // below what each word points to
    std::uint64_t starts = 0;                  // words that are masks
};

}  // namespace octavo
#endif

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Classifies 64 words of a level: a mask, as it is below 256 and no pointer is, or a pointer to a
/// node of the next level. @return whether each of them is one of the two
template <int kEntryBytes>
bool look_up(const std::uint32_t* HWY_RESTRICT words, const LevelRange& next,
             const std::uint8_t* HWY_RESTRICT table, Group& group) {
    const hn::CappedTag<std::uint32_t, 16> d;
    const hn::RebindToSigned<decltype(d)> di;
    const auto one = hn::Set(d, 1u);
    const auto zero = hn::Zero(d);
    const auto masks = hn::Set(d, kChildMaskBits);
    const auto next_begin = hn::Set(d, static_cast<std::uint32_t>(next.begin));
    const auto next_size = hn::Set(d, static_cast<std::uint32_t>(next.size()));
    const auto entry_bits =
        hn::Set(d, static_cast<std::uint32_t>((std::uint64_t{1} << 8 * kEntryBytes) - 1));
    auto odd = zero;
    group.starts = 0;
    for (std::size_t i = 0; i < kGroup; i += hn::Lanes(d)) {
        const auto word = hn::LoadU(d, words + i);
        const auto is_mask = hn::Lt(hn::Sub(word, one), masks);
        const auto at = hn::Sub(word, next_begin);
        const auto inside = hn::Lt(at, next_size);
        const auto safe = hn::IfThenElseZero(inside, at);
        const auto pair = hn::ShiftRight<1>(safe);
        auto entry = zero;
        if constexpr (kEntryBytes == 4) {
            entry = hn::BitCast(d, hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(table),
                                                   hn::BitCast(di, pair)));
        } else {
            const auto offset = kEntryBytes == 1 ? pair : hn::Sub(safe, hn::And(safe, one));
            entry = hn::And(
                entry_bits,
                hn::BitCast(d, hn::GatherOffset(di, reinterpret_cast<const std::int32_t*>(table),
                                                hn::BitCast(di, offset))));
        }
        const auto other_half = hn::And(hn::Xor(entry, safe), one);
        const auto is_pointer =
            hn::AndNot(hn::Eq(entry, zero), hn::And(inside, hn::Eq(other_half, zero)));
        odd = hn::Or(odd, hn::IfThenZeroElse(hn::Or(is_mask, is_pointer), one));
        hn::StoreU(hn::IfThenElseZero(inside, hn::ShiftRight<1>(entry)), d,
                   group.voxels.data() + i);
        std::array<std::uint8_t, 8> bits{};
        hn::StoreMaskBits(d, is_mask, bits.data());
        std::uint64_t starts = 0;
        std::memcpy(&starts, bits.data(), bits.size());
        group.starts |= starts << i;
    }
    return hn::AllTrue(d, hn::Eq(odd, zero));
}

bool LookUp(int entry_bytes, const std::uint32_t* words, const LevelRange& next,
            const std::uint8_t* table, Group& group) {
    if (entry_bytes == 1) return look_up<1>(words, next, table, group);
    if (entry_bytes == 2) return look_up<2>(words, next, table, group);
    return look_up<4>(words, next, table, group);
}

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octavo {

HWY_EXPORT(LookUp);

namespace {

/// A word below this can be no pointer into a level that begins here or behind it.
constexpr std::uint64_t kAboveMasks = kChildMaskBits + 1;

/// Voxels fit in 3 (height) bits and one more, and the entry has another.
int entry_bytes_for(std::size_t height) {
    if (height <= 2) return 1;   // 64
    if (height <= 4) return 2;   // 2^12
    if (height <= 10) return 4;  // 2^30
    return 8;
}

class SoundChecker {
public:
    SoundChecker(std::span<const std::uint64_t> begins, std::span<const std::uint32_t> words)
        : begins_(begins), words_(words), leaf_level_(begins.size() - 2) {}

    std::optional<std::uint64_t> run(std::span<const std::uint64_t> level_nodes) {
        if (!read_leaves()) return std::nullopt;
        if (leaf_level_ == 0 && level(0).size() != kLeafWords) return std::nullopt;
        if (!level_nodes.empty() &&
            level_nodes[leaf_level_] != level(leaf_level_).size() / kLeafWords)
            return std::nullopt;
        for (std::size_t l = leaf_level_; l-- > 0;) {
            const auto nodes = read_level(l);
            if (!nodes || (l == 0 && *nodes != 1)) return std::nullopt;
            if (!level_nodes.empty() && level_nodes[l] != *nodes) return std::nullopt;
        }
        return below_.entry(0) >> 1;
    }

private:
    [[nodiscard]] LevelRange level(std::size_t l) const { return {begins_[l], begins_[l + 1]}; }
    [[nodiscard]] const std::uint32_t* words_of(const LevelRange& level) const {
        return words_.data() + level.begin;
    }

    static PairTable make_table(const LevelRange& level, std::size_t height) {
        const int bytes = entry_bytes_for(height);
        // A gather reads four bytes wherever it reads.
        return {allocate_mapping((level.size() / 2 + 1) * static_cast<std::uint64_t>(bytes) +
                                 sizeof(std::uint32_t)),
                bytes};
    }

    bool read_leaves() {
        const LevelRange leaves = level(leaf_level_);
        if (leaves.size() % kLeafWords != 0) return false;
        below_ = make_table(leaves, 2);
        auto* const entries = below_.entries<std::uint8_t>();
        const std::uint32_t* const words = words_of(leaves);
        return all_parts(leaves.size() / kLeafWords, [&](std::uint64_t begin, std::uint64_t end) {
            bool empty = false;
            for (std::uint64_t i = begin; i < end; ++i) {
                const int voxels =
                    std::popcount(words[2 * i] | std::uint64_t{words[2 * i + 1]} << 32);
                entries[i] = static_cast<std::uint8_t>(2 * voxels);
                empty |= voxels == 0;
            }
            return !empty;
        });
    }

    /// Replaces the table of the level below by this one's. @return its number of nodes, if sound
    std::optional<std::uint64_t> read_level(std::size_t l) {
        PairTable table = make_table(level(l), begins_.size() - l);
        std::optional<std::uint64_t> nodes;
        switch (table.entry_bytes) {
            case 2:
                nodes = read_level(l, table.entries<std::uint16_t>());
                break;
            case 4:
                nodes = read_level(l, table.entries<std::uint32_t>());
                break;
            default:
                nodes = read_level(l, table.entries<std::uint64_t>());
                break;
        }
        below_ = std::move(table);
        return nodes;
    }

    template <typename Entry>
    std::optional<std::uint64_t> read_level(std::size_t l, Entry* entries) {
        const LevelRange next = level(l + 1);
        // The first levels are of some words; and a gather's offsets have 31 bits.
        if (next.begin < kAboveMasks || below_.entry_bytes == 8 || next.size() >> 31 != 0)
            return walk(l, entries);
        std::atomic<std::uint64_t> nodes{0};
        if (!all_parts(level(l).size(), [&](std::uint64_t begin, std::uint64_t end) {
                const auto found = scan(l, begin, end, entries);
                nodes += found.value_or(0);
                return found.has_value();
            }))
            return std::nullopt;
        return nodes.load();
    }

    /// From node to node, for any words.
    template <typename Entry>
    std::optional<std::uint64_t> walk(std::size_t l, Entry* entries) const {
        const LevelRange here = level(l), next = level(l + 1);
        const std::uint32_t* const words = words_of(here);
        std::uint64_t nodes = 0;
        for (std::uint64_t at = 0; at < here.size(); ++nodes) {
            const auto size = static_cast<std::uint64_t>(node_words(words[at]));
            if (words[at] - 1 >= kChildMaskBits || size > here.size() - at) return std::nullopt;
            std::uint64_t voxels = 0;
            for (std::uint64_t i = at + 1; i < at + size; ++i) {
                const std::uint64_t target = words[i] - next.begin;
                if (target >= next.size()) return std::nullopt;
                const std::uint64_t entry = below_.entry(target / 2);
                if (entry == 0 || (entry ^ target) & 1u) return std::nullopt;
                voxels += entry >> 1;
            }
            entries[at / 2] = static_cast<Entry>(voxels << 1 | (at & 1u));
            at += size;
        }
        return nodes;
    }

    /// Reads the nodes that begin in [begin, end) of a level, 64 words at a time. Where a node
    /// begins is seen from the words themselves; that it has as many pointers as its mask says is
    /// seen from where the next one begins. No part needs another one's end.
    template <typename Entry>
    std::optional<std::uint64_t> scan(std::size_t l, std::uint64_t begin, std::uint64_t end,
                                      Entry* entries) const {
        const LevelRange here = level(l), next = level(l + 1);
        const std::uint32_t* const words = words_of(here);
        const auto* const table =
            reinterpret_cast<const std::uint8_t*>(below_.memory->bytes().data());
        const auto look = HWY_DYNAMIC_DISPATCH(LookUp);

        // The words before its first node are the end of a node that begins before the part.
        std::uint64_t node = begin;
        while (node < end && words[node] >= kAboveMasks) ++node;
        if (node - begin >= kMaxNodeWords || (begin == 0 && node != 0)) return std::nullopt;
        if (node == end)  // the level ends with the words of a node that began before
            return end == here.size() ? std::optional<std::uint64_t>(0) : std::nullopt;

        Group group;
        std::array<std::uint32_t, kGroup> last;
        std::array<std::uint64_t, kGroup + 1> sums;  // of voxels before each word
        sums[kGroup] = 0;
        std::uint64_t before_node = 0;
        std::uint64_t nodes = 0;
        bool sound = true;
        const auto end_node = [&](std::uint64_t at, std::uint64_t sum) {
            sound &= at - node == static_cast<std::uint64_t>(node_words(words[node]));
            entries[node / 2] = static_cast<Entry>((sum - before_node) << 1 | (node & 1u));
            ++nodes;
        };
        for (std::uint64_t at = node; at < here.size() && sound; at += kGroup) {
            const std::uint64_t count = std::min(kGroup, here.size() - at);
            const std::uint32_t* some = words + at;
            if (count < kGroup) {
                last.fill(1);
                std::copy_n(some, count, last.begin());
                some = last.data();
            }
            sound &= look(below_.entry_bytes, some, next, table, group);
            sums[0] = sums[kGroup];
            for (std::size_t i = 0; i < kGroup; ++i) sums[i + 1] = sums[i] + group.voxels[i];
            std::uint64_t starts = group.starts;
            if (count < kGroup) starts &= (std::uint64_t{1} << count) - 1;
            if (at == node && nodes == 0) starts &= starts - 1;  // the first, which has no end yet
            for (; starts != 0; starts &= starts - 1) {
                const auto i = static_cast<unsigned>(std::countr_zero(starts));
                end_node(at + i, sums[i]);
                node = at + i;
                before_node = sums[i];
                if (node >= end) return sound ? std::optional(nodes) : std::nullopt;
            }
        }
        end_node(here.size(), sums[kGroup]);
        return sound ? std::optional(nodes) : std::nullopt;
    }

    /// Runs check(begin, end) over parts of [0, count) on all threads. @return whether all hold
    template <typename Check>
    static bool all_parts(std::uint64_t count, const Check& check) {
        constexpr std::uint64_t kPart = 1 << 15;
        std::atomic<bool> all{true};
        tbb::parallel_for(std::uint64_t{0}, (count + kPart - 1) / kPart, [&](std::uint64_t part) {
            if (all.load(std::memory_order_relaxed) &&
                !check(part * kPart, std::min(count, (part + 1) * kPart)))
                all = false;
        });
        return all;
    }

    std::span<const std::uint64_t> begins_;
    std::span<const std::uint32_t> words_;
    std::size_t leaf_level_;
    PairTable below_;
};

}  // namespace

std::optional<std::uint64_t> voxels_if_sound(std::span<const std::uint64_t> level_begins,
                                             std::span<const std::uint32_t> words,
                                             std::span<const std::uint64_t> level_nodes) {
    return SoundChecker(level_begins, words).run(level_nodes);
}

}  // namespace octavo
#endif
