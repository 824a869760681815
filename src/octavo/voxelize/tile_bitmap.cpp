// SPDX-License-Identifier: MIT
#include "octavo/voxelize/tile_bitmap.h"

#include <bit>
#include <utility>

namespace octavo {

void TileBitmap::take(std::vector<LeafBlock>& leaves) {
    leaves.clear();
    take_below(occupied_.size() - 1, 0, leaves);
}

// The recursion is as deep as there are levels of 64: four for a tile of 1024^3.
void TileBitmap::take_below(std::size_t level, std::uint32_t word_index,
                            std::vector<LeafBlock>& leaves) {
    std::uint64_t bits = std::exchange(occupied_[level][word_index], 0);
    for (; bits != 0; bits &= bits - 1) {
        const std::uint32_t below = word_index * 64 + static_cast<unsigned>(std::countr_zero(bits));
        if (level > 0) {
            take_below(level - 1, below, leaves);
        } else {
            leaves.push_back({std::exchange(blocks_[below], 0), below});
        }
    }
}

}  // namespace octavo
