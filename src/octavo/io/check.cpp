// SPDX-License-Identifier: MIT
#include "octavo/io/check.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <iterator>
#include <utility>
#include <variant>

#include "octavo/core/grid.h"
#include "octavo/dag/node.h"
#include "octavo/io/node_starts.h"
#include "octavo/io/sound.h"

namespace octavo {
namespace {

using Words = std::span<const std::uint32_t>;
using Faults = std::vector<DagFault>;

// A node of level l stands for at most 8^(depth - l) voxels, as its children do for an eighth of
// that each: once pointers only lead one level down, no sum below can pass 2^64.
static_assert(3 * kMaxDepth < 64);

std::optional<DagFault> begins_fault(std::span<const std::uint64_t> begins, std::uint64_t words) {
    const auto fault = [](std::uint64_t word, std::string reason) {
        return DagFault{"levels", word, std::move(reason)};
    };
    if (begins.size() < kMinDepth || begins.size() > kMaxDepth)
        return fault(0, "the number of levels is not in 2 to 17");
    if (begins.front() != 0) return fault(0, "level 0 does not begin at word 0");
    for (std::size_t i = 1; i < begins.size(); ++i)
        if (begins[i] < begins[i - 1])
            return fault(begins[i], "level " + std::to_string(i) + " begins before the one above");
    if (begins.back() != words)
        return fault(begins.back(), "the levels do not end where the words do");
    if (words > std::uint64_t{1} << 32) return fault(0, "more than 2^32 words");
    return std::nullopt;
}

/// Voxels below each node of one level, in the narrowest numbers that hold them: what bounds the
/// check is how much memory it reads here and there, and most nodes are low.
using VoxelCounts = std::variant<std::vector<std::uint8_t>, std::vector<std::uint16_t>,
                                 std::vector<std::uint32_t>, std::vector<std::uint64_t>>;

/// @param height  of the nodes' level above the voxels: 2 for leaves
VoxelCounts make_counts(std::size_t height, std::uint64_t nodes) {
    if (height <= 2) return std::vector<std::uint8_t>(nodes);    // 64
    if (height <= 5) return std::vector<std::uint16_t>(nodes);   // 2^15
    if (height <= 10) return std::vector<std::uint32_t>(nodes);  // 2^30
    return std::vector<std::uint64_t>(nodes);
}

class DagChecker {
public:
    DagChecker(std::span<const std::uint64_t> begins, Words words, const DagClaims& claims,
               const DagCheckOptions& options)
        : begins_(begins),
          words_(words),
          claims_(claims),
          options_(options),
          leaf_level_(begins.size() - 2),
          starts_(leaf_level_) {}

    Faults run() {
        check_leaves();
        tbb::parallel_for(std::size_t{0}, leaf_level_, [&](std::size_t level) {
            starts_[level].scan(words_, range(level), options_.max_faults);
        });
        for (NodeStarts& starts : starts_) take(std::move(starts.faults()));
        check_node_counts();
        // Even where faults are known: the walks above have made sure that nothing is followed that
        // cannot be.
        for (std::size_t level = leaf_level_; level-- > 0 && !full();) check_pointers(level);
        if (faults_.empty()) check_voxels();
        if (faults_.empty() && options_.strict) {
            check_strictly();
            for (DagFault& fault : faults_) fault.strict_only = true;
        }
        std::ranges::stable_sort(faults_, {}, &DagFault::word);
        return std::move(faults_);
    }

private:
    [[nodiscard]] LevelRange range(std::size_t level) const {
        return {begins_[level], begins_[level + 1]};
    }
    [[nodiscard]] bool full() const { return faults_.size() >= options_.max_faults; }

    void add(std::string_view code, std::uint64_t word, std::string reason) {
        if (!full()) faults_.push_back({code, word, std::move(reason)});
    }
    void take(Faults&& more) { append(faults_, std::move(more)); }
    void append(Faults& to, Faults&& more) const {
        const std::size_t room = options_.max_faults - std::min(options_.max_faults, to.size());
        if (more.size() > room) more.resize(room);
        std::ranges::move(more, std::back_inserter(to));
    }

    /// Calls check(begin, end, faults) for parts of [0, count) on all threads; faults keep the
    /// order of the parts.
    template <typename Check>
    void check_parts(std::uint64_t count, std::uint64_t grain, const Check& check) {
        take(tbb::parallel_reduce(
            tbb::blocked_range<std::uint64_t>(0, count, grain), Faults{},
            [&](const tbb::blocked_range<std::uint64_t>& part, Faults faults) {
                if (faults.size() < options_.max_faults) check(part.begin(), part.end(), faults);
                return faults;
            },
            [&](Faults left, Faults right) {
                append(left, std::move(right));
                return left;
            }));
    }

    void check_leaves() {
        const LevelRange leaves = range(leaf_level_);
        if (leaves.size() % kLeafWords != 0)
            add("leaf-odd", leaves.begin, "the leaf level has an odd number of words");
        const std::uint64_t count = leaves.size() / kLeafWords;
        std::vector<std::uint8_t> voxels(count);
        check_parts(count, 1 << 16, [&](std::uint64_t begin, std::uint64_t end, Faults& faults) {
            for (std::uint64_t i = begin; i < end; ++i) {
                const std::uint64_t word = leaves.begin + i * kLeafWords;
                voxels[i] = static_cast<std::uint8_t>(
                    std::popcount(words_[word] | std::uint64_t{words_[word + 1]} << 32));
                if (voxels[i] == 0 && faults.size() < options_.max_faults)
                    faults.push_back({"leaf-empty", word, "a leaf without voxels"});
            }
        });
        voxels_below_ = std::move(voxels);
    }

    void check_node_counts() {
        for (std::size_t level = 0; level <= leaf_level_; ++level) {
            const bool leaves = level == leaf_level_;
            const std::uint64_t found =
                leaves ? range(level).size() / kLeafWords : starts_[level].count();
            // Where a walk has stopped, its count says nothing.
            const bool whole =
                leaves || range(level).size() == 0 || starts_[level].known(range(level).end - 1);
            if (!whole) continue;
            if (!claims_.level_nodes.empty() && claims_.level_nodes[level] != found)
                add("node-count", begins_[level],
                    "level " + std::to_string(level) + " has " + std::to_string(found) +
                        " nodes where " + std::to_string(claims_.level_nodes[level]) +
                        " are stated");
            if (level == 0 && found != 1) add("root", 0, "level 0 is not a single node");
        }
    }

    /// Checks the pointers of one level, and adds up the voxels below each of its nodes.
    void check_pointers(std::size_t level) {
        const std::size_t height = begins_.size() - level;
        VoxelCounts sums = make_counts(height, starts_[level].count());
        std::visit([&](auto& sum, const auto& below) { check_pointers(level, sum, below); }, sums,
                   voxels_below_);
        voxels_below_ = std::move(sums);
    }

    template <typename Sum, typename Below>
    void check_pointers(std::size_t level, std::vector<Sum>& sums,
                        const std::vector<Below>& below) {
        const LevelRange next = range(level + 1);
        if (level + 1 == leaf_level_) {
            follow(
                level, next, sums, [&](std::uint64_t at) { prefetch(below, at / kLeafWords); },
                [&](std::uint64_t at, Sum& sum) {
                    // An odd level ends in half a leaf, which has no count.
                    if (at % kLeafWords != 0 || at / kLeafWords >= below.size()) return false;
                    sum = static_cast<Sum>(sum + below[at / kLeafWords]);
                    return true;
                });
        } else {
            const NodeStarts& starts = starts_[level + 1];
            follow(
                level, next, sums,
                [&](std::uint64_t at) { prefetch(starts.blocks(), at / NodeStarts::kWords); },
                [&](std::uint64_t at, Sum& sum) {
                    const std::uint64_t word = next.begin + at;
                    if (!starts.known(word)) return true;
                    if (!starts.contains(word)) return false;
                    sum = static_cast<Sum>(sum + below[starts.rank(word)]);
                    return true;
                });
        }
    }

    template <typename Array>
    static void prefetch(const Array& array, std::uint64_t i) {
        __builtin_prefetch(array.data() + i);
    }

    /// @param soon   (at): this word of the next level will be entered
    /// @param enter  (at, sum): whether a node begins at this word of the next level; if so, adds
    ///               what is in it to the sum
    template <typename Sum, typename Soon, typename Enter>
    void follow(std::size_t level, const LevelRange& next, std::vector<Sum>& sums, const Soon& soon,
                const Enter& enter) {
        constexpr std::uint64_t kAhead = 24;  // words; 12 to 48 are as good
        const NodeStarts& starts = starts_[level];
        const std::uint64_t last_word = words_.size() - 1;
        check_parts(
            starts.blocks().size(), 256,
            [&](std::uint64_t first, std::uint64_t last, Faults& faults) {
                starts.for_each(first, last, [&](std::uint64_t node, std::uint64_t number) {
                    const auto size = static_cast<unsigned>(node_words(words_[node]));
                    Sum sum = 0;
                    for (std::uint64_t word = node + 1; word < node + size; ++word) {
                        const std::uint64_t ahead = words_[std::min(word + kAhead, last_word)];
                        if (next.holds(ahead)) soon(ahead - next.begin);
                        const std::uint64_t target = words_[word];
                        const bool holds = next.holds(target);
                        if (holds && enter(target - next.begin, sum)) continue;
                        if (faults.size() == options_.max_faults) continue;
                        const std::string pointer = "pointer " + std::to_string(target);
                        if (holds)
                            faults.push_back({"pointer-inside", word,
                                              pointer + " leads into the middle of a node"});
                        else
                            faults.push_back({"pointer-outside", word,
                                              pointer + " leads outside the next level"});
                    }
                    sums[number] = sum;
                });
            });
    }

    void check_voxels() {
        if (!claims_.voxels) return;
        const std::uint64_t found =
            std::visit([](const auto& counts) { return std::uint64_t{counts[0]}; }, voxels_below_);
        if (found != *claims_.voxels)
            add("voxel-count", 0,
                "the DAG holds " + std::to_string(found) + " voxels where " +
                    std::to_string(*claims_.voxels) + " are stated");
    }

    void check_strictly() {
        std::vector<bool> reached{true};  // by number of the node in its level
        for (std::size_t level = 0; level <= leaf_level_; ++level) {
            for_each_node(level, [&](std::uint64_t word, std::uint64_t number) {
                if (!reached[number])
                    add("node-unreachable", word, "no pointer leads to this node");
            });
            check_unique(level);
            if (level < leaf_level_) reached = reach(level, reached);
        }
    }

    template <typename Visit>
    void for_each_node(std::size_t level, const Visit& visit) const {
        if (level < leaf_level_) {
            starts_[level].for_each(0, starts_[level].blocks().size(), visit);
            return;
        }
        const LevelRange leaves = range(level);
        for (std::uint64_t i = 0; i < leaves.size() / kLeafWords; ++i)
            visit(leaves.begin + i * kLeafWords, i);
    }
    [[nodiscard]] std::uint64_t number_of(std::size_t level, std::uint64_t word) const {
        return level < leaf_level_ ? starts_[level].rank(word)
                                   : (word - begins_[level]) / kLeafWords;
    }

    /// Which nodes of the next level those of this one lead to. In the order of record 3 each is
    /// already known when it is met, or is the first that is not.
    std::vector<bool> reach(std::size_t level, const std::vector<bool>& reached) {
        const std::uint64_t count = level + 1 < leaf_level_ ? starts_[level + 1].count()
                                                            : range(level + 1).size() / kLeafWords;
        std::vector<bool> next(count);
        std::uint64_t next_new = 0;
        bool in_order = true;
        for_each_node(level, [&](std::uint64_t node, std::uint64_t number) {
            if (!reached[number]) return;
            const auto size = static_cast<unsigned>(node_words(words_[node]));
            for (std::uint64_t word = node + 1; word < node + size; ++word) {
                const std::uint64_t child = number_of(level + 1, words_[word]);
                if (next[child]) continue;
                next[child] = true;
                if (child != next_new && std::exchange(in_order, false))
                    add("node-order", words_[word],
                        "level " + std::to_string(level + 1) +
                            " is not in the order in which its nodes are first met: node " +
                            std::to_string(child) + " comes before node " +
                            std::to_string(next_new));
                ++next_new;
            }
        });
        return next;
    }

    [[nodiscard]] Words node_at(std::size_t level, std::uint64_t word) const {
        return words_.subspan(word, level < leaf_level_
                                        ? static_cast<std::size_t>(node_words(words_[word]))
                                        : kLeafWords);
    }

    void check_unique(std::size_t level) {
        struct Entry {
            std::uint64_t hash;
            std::uint64_t word;
        };
        std::vector<Entry> entries;
        for_each_node(level, [&](std::uint64_t word, std::uint64_t) {
            const Words node = node_at(level, word);
            entries.push_back({XXH3_64bits(node.data(), node.size_bytes()), word});
        });
        // Nodes may be made to have equal hashes, so content decides.
        tbb::parallel_sort(entries, [&](const Entry& a, const Entry& b) {
            if (a.hash != b.hash) return a.hash < b.hash;
            const Words x = node_at(level, a.word);
            const Words y = node_at(level, b.word);
            if (!std::ranges::equal(x, y)) return std::ranges::lexicographical_compare(x, y);
            return a.word < b.word;
        });
        for (std::size_t i = 1; i < entries.size() && !full(); ++i)
            if (entries[i].hash == entries[i - 1].hash &&
                std::ranges::equal(node_at(level, entries[i].word),
                                   node_at(level, entries[i - 1].word)))
                add("node-duplicate", entries[i].word,
                    "the same as the node at word " + std::to_string(entries[i - 1].word));
    }

    std::span<const std::uint64_t> begins_;
    Words words_;
    const DagClaims& claims_;
    const DagCheckOptions& options_;
    std::size_t leaf_level_;
    std::vector<NodeStarts> starts_;  // of the interior levels
    VoxelCounts voxels_below_;        // of the level checked last
    Faults faults_;
};

}  // namespace

std::vector<DagFault> find_faults(std::span<const std::uint64_t> level_begins, Words words,
                                  const DagClaims& claims, const DagCheckOptions& options) {
    if (auto fault = begins_fault(level_begins, words.size())) return {std::move(*fault)};
    if (words.empty()) {
        if (claims.voxels.value_or(0) == 0) return {};
        return {{"voxel-count", 0, "the DAG is empty where voxels are stated"}};
    }
    // Nearly every file is sound, and that is told sooner than what is wrong.
    if (!options.strict) {
        const auto voxels = voxels_if_sound(level_begins, words, claims.level_nodes);
        if (voxels && *voxels == claims.voxels.value_or(*voxels)) return {};
    }
    return DagChecker(level_begins, words, claims, options).run();
}

}  // namespace octavo
