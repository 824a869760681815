// SPDX-License-Identifier: MIT
#include "octavo/construct/sampled_nodes.h"

#include <bit>

namespace octavo {

std::uint32_t SampledNodes::merge(const NodeStore& tile, unsigned piece) {
    const auto bit = static_cast<std::uint16_t>(1u << piece);
    return store_.merge_root(tile, [&](int height, std::uint32_t id) {
        std::vector<std::uint16_t>& met = pieces_[static_cast<unsigned>(height)];
        if (id / 2 >= met.size()) met.resize(id / 2 + 1);
        met[id / 2] |= bit;
    });
}

std::array<double, SampledNodes::kPieces> SampledNodes::growth_curve(int height) const {
    std::array<double, kPieces + 1> met_by{};
    for (const std::uint16_t pieces : pieces_[static_cast<unsigned>(height)])
        met_by[static_cast<unsigned>(std::popcount(pieces))] += 1.0;

    // Of k pieces none has a node that m of all have with a chance of
    // (16 - m)! (16 - k)! / (16! (16 - m - k)!).
    std::array<double, kPieces> curve{};
    for (unsigned m = 1; m <= kPieces; ++m) {
        double none_has_it = 1.0;
        for (unsigned k = 1; k <= kPieces; ++k) {
            none_has_it *= m + k > kPieces ? 0.0
                                           : static_cast<double>(kPieces - m - k + 1) /
                                                 static_cast<double>(kPieces - k + 1);
            curve[k - 1] += met_by[m] * (1.0 - none_has_it);
        }
    }
    return curve;
}

std::uint64_t SampledNodes::count() const {
    std::uint64_t nodes = 0;
    for (int h = 0; h <= store_.top(); ++h) nodes += store_.level(h).count();
    return nodes;
}

std::uint64_t SampledNodes::memory_bytes() const {
    std::uint64_t bytes = store_.memory_bytes();
    for (const auto& met : pieces_) bytes += met.capacity() * sizeof(std::uint16_t);
    return bytes;
}

}  // namespace octavo
