// SPDX-License-Identifier: MIT
#include "octavo/io/node_starts.h"

#include <algorithm>
#include <string_view>

#include "octavo/dag/node.h"

namespace octavo {

void NodeStarts::scan(std::span<const std::uint32_t> words, const LevelRange& level,
                      std::size_t max_faults) {
    begin_ = level.begin;
    blocks_.resize((level.size() + kWords - 1) / kWords);
    const std::uint32_t* const first = words.data() + level.begin;
    const std::uint64_t size = level.size();
    std::uint64_t at = 0;
    for (std::uint64_t b = 0; b < blocks_.size(); ++b) {
        blocks_[b].before = count_;
        const std::uint64_t block_begin = b * kWords;
        const std::uint64_t block_end = std::min(size, block_begin + kWords);
        std::uint64_t bits = 0;
        for (; at < block_end; ++count_) {
            const std::uint32_t mask = first[at];
            const auto node = static_cast<std::uint64_t>(node_words(mask));
            if (mask - 1 >= kChildMaskBits || node > size - at) {
                if (!accept_oddity(at, mask, node, size, max_faults)) {
                    blocks_[b].bits = bits;
                    for (++b; b < blocks_.size(); ++b) blocks_[b].before = count_;
                    known_ = at;
                    return;
                }
            }
            bits |= std::uint64_t{1} << (at - block_begin);
            at += node;
        }
        blocks_[b].bits = bits;
    }
    known_ = size;
}

bool NodeStarts::accept_oddity(std::uint64_t at, std::uint32_t mask, std::uint64_t node,
                               std::uint64_t size, std::size_t max_faults) {
    const auto add = [&](std::string_view code, const char* reason) {
        if (faults_.size() < max_faults) faults_.push_back({code, begin_ + at, reason});
    };
    if (mask & ~kChildMaskBits) add("node-spare-bits", "spare bits of a node are not zero");
    if ((mask & kChildMaskBits) == 0) {
        add("node-empty", "a node without children");
        return false;
    }
    if (node > size - at) {
        add("node-overrun", "a node reaches past the end of its level");
        return false;
    }
    return true;
}

}  // namespace octavo
