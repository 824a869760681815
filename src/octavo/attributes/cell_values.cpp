// SPDX-License-Identifier: MIT
#include "octavo/attributes/cell_values.h"

#include <algorithm>

namespace octavo {

std::optional<CellValues::Fault> CellValues::find_fault(std::span<const std::uint32_t> words,
                                                        std::uint64_t count, int value_bits) {
    const std::uint64_t blocks = (count + kBlockCells - 1) / kBlockCells;
    if (words.size() > kMaxWords) return Fault{0, "too many words"};
    if (words.size() < kHeaderWords || words.size() - kHeaderWords < blocks)
        return Fault{words.size(), "the table of blocks is cut off"};
    const auto width = static_cast<std::uint32_t>(value_bits);
    if (words[0] != width) return Fault{0, "the values have another number of bits"};
    if (words[1] != blocks) return Fault{1, "the number of blocks is not that of the cells"};

    const std::uint64_t data = kHeaderWords + blocks;
    for (std::uint64_t b = 0; b < blocks; ++b) {
        const std::uint64_t begin = words[kHeaderWords + b];
        if (begin == 0) continue;
        if (begin < data || begin >= words.size())
            return Fault{kHeaderWords + b, "a block begins outside the data"};
        const std::uint64_t room = 32 * (words.size() - begin - 1);
        const std::uint64_t cells = std::min<std::uint64_t>(kBlockCells, count - b * kBlockCells);
        const std::uint32_t form = words[begin];
        const std::uint32_t index_bits = form & 0xffu, palette = form >> 8;
        if (index_bits == kRaw) {
            if (palette != 0) return Fault{begin, "a block without a palette states one"};
            if (cells * width > room) return Fault{begin, "a block reaches past the end"};
            continue;
        }
        if (index_bits > 8 || palette == 0 || palette > kMaxPalette)
            return Fault{begin, "a block has an unknown form"};
        if (std::uint64_t{palette} * width + cells * index_bits > room)
            return Fault{begin, "a block reaches past the end"};
        if (palette >= 1u << index_bits) continue;
        const CellValues block(words, count, nullptr);
        for (std::uint32_t i = 0; i < cells; ++i)
            if (block.bits(static_cast<std::uint32_t>(begin) + 1, palette * width + i * index_bits,
                           index_bits) >= palette)
                return Fault{begin, "an index is past the end of its palette"};
    }
    return std::nullopt;
}

}  // namespace octavo
