// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "octavo/construct/node_store.h"

namespace octavo {

/// The different nodes of a sample of tiles, and in which of sixteen pieces of it each was met:
/// this tells how the number of different nodes grows with what is looked at.
class SampledNodes {
public:
    static constexpr unsigned kPieces = 16;

    /// @param top  the greatest height that nodes will have
    explicit SampledNodes(int top) : store_(top), pieces_(static_cast<unsigned>(top) + 1) {}

    [[nodiscard]] NodeStore& store() { return store_; }

    /// Adds the nodes of a tile, which is in this piece. @return the id of the tile's node
    std::uint32_t merge(const NodeStore& tile, unsigned piece);

    /// How many nodes of this height 1, 2 ... 16 of the pieces have together, on average over all
    /// ways of choosing these; only of tiles, not of what is above them. One pass over the nodes.
    [[nodiscard]] std::array<double, kPieces> growth_curve(int height) const;

    /// Of all heights.
    [[nodiscard]] std::uint64_t count() const;

    [[nodiscard]] std::uint64_t memory_bytes() const;

private:
    NodeStore store_;
    // [height][id / 2]: bit i is set where piece i has the node. A node takes two words or more.
    std::vector<std::vector<std::uint16_t>> pieces_;
};

}  // namespace octavo
