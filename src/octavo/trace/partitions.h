// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "octavo/dag/dag.h"

namespace octavo {

/// Beside a DAG, for its nodes of one height: which parts of a node's faces the empty space inside
/// connects. A ray that goes in at one part and out at another, unconnected, is certainly occluded,
/// without a step below the node: docs/adr/0032-partitions.md.
///
/// Made once for a DAG and shared by all who trace it, on any thread. Results do not depend on it.
/// A node's table is made when rays ask for it, while tables earn what they cost; or all at once by
/// make_all().
class Partitions {
public:
    /// A table, of one byte for each of 8 x 8 x 8 blocks of the node, x + 8y + 64z. Only those at
    /// its faces count: a bit for each connected part of the empty space that has a voxel both in
    /// the block and on the face. Voxels that share a corner are connected. From the eighth on all
    /// parts have the same bit. Where two blocks have no bit in common, no way leads from one to
    /// the other.
    static constexpr int kBlocks = 8;
    static constexpr std::size_t kTableBytes = std::size_t{kBlocks} * kBlocks * kBlocks;

    /// When a table is made: when so many rays have asked for it that it is likely to pay within
    /// one picture; or for the first that does, as long as tables are of use at all, for many
    /// pictures.
    enum class Pace { picture, flight };

    /// For nodes of a width that pays soon: a sixty-fourth of the grid for a picture, 64 to 256
    /// voxels; a thirty-second for a flight, 64 to 512 (docs/adr/0039-what-a-table-costs.md).
    explicit Partitions(const Dag& dag, Pace pace = Pace::picture)
        : Partitions(dag, usual_height(dag.depth(), pace), pace) {}
    /// @param height  of the nodes, 3 to depth - 1; any other is for a DAG without tables
    Partitions(const Dag& dag, int height, Pace pace = Pace::picture);

    /// Of the nodes that have tables; 0 where none has.
    [[nodiscard]] int height() const { return height_; }

    /// The table of a node of this height, by its word in the DAG, for some rays that would like
    /// it; nullptr where there is none yet. Its bytes may be read four at a time.
    const std::uint8_t* find(std::uint32_t node, int rays) noexcept {
        const std::uint32_t state = states_[place(node)].load(std::memory_order_acquire);
        return state > kMaking ? table(state - kMaking - 1) : want(node, rays);
    }
    /// Says that so many rays were found to be occluded by tables.
    void earn(std::size_t rays) noexcept { earned_.fetch_add(rays, std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t earned() const { return earned_.load(std::memory_order_relaxed); }
    /// Whether tables have answered as many rays as they cost, but for the first few.
    [[nodiscard]] bool pays() const noexcept {
        return count() < kFirstTables + earned() / rays_for_table_;
    }
    /// Where they do not: what the last rays' search for proofs leaves to those that follow.
    [[nodiscard]] int credit() const noexcept { return credit_.load(std::memory_order_relaxed); }
    void set_credit(int credit) noexcept { credit_.store(credit, std::memory_order_relaxed); }

    /// Makes all, on all threads of the arena. Cost  docs/adr/0032-partitions.md
    void make_all();

    [[nodiscard]] std::size_t count() const { return count_.load(std::memory_order_relaxed); }
    /// With what finds them. At most half of the DAG's own size, or 128 KiB.
    [[nodiscard]] std::uint64_t size_bytes() const {
        return states_count_ * sizeof(states_[0]) + count() * kTableBytes;
    }

private:
    // A node's state: rays that asked for it, or kMaking, or kMaking + 1 + the number of its table.
    static constexpr std::uint32_t kMaking = 1u << 16;
    static constexpr std::size_t kFirstTables = 32;  // before any has answered a ray

    [[nodiscard]] static int usual_height(int depth, Pace pace);
    /// A node has two words or more.
    [[nodiscard]] std::size_t place(std::uint32_t node) const { return (node - first_word_) / 2; }
    [[nodiscard]] std::uint8_t* table(std::uint32_t number) const {
        return tables_.get() + number * kTableBytes;
    }
    const std::uint8_t* want(std::uint32_t node, int rays) noexcept;
    const std::uint8_t* make(std::uint32_t node) noexcept;

    Dag dag_;
    std::uint32_t rays_for_table_;
    int height_ = 0;
    std::uint64_t first_word_ = 0;  // of the level
    std::uint64_t last_word_ = 0;
    std::size_t states_count_ = 0;
    std::size_t most_ = 0;
    std::unique_ptr<std::atomic<std::uint32_t>[]> states_;
    std::unique_ptr<std::uint8_t[]>
        tables_;  // room for all, of which the system gives what is used
    std::atomic<std::uint32_t> count_{0};
    std::atomic<std::uint64_t> earned_{0};
    std::atomic<int> credit_{0};
};

}  // namespace octavo
