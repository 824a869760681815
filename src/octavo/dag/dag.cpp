// SPDX-License-Identifier: MIT
#include "octavo/dag/dag.h"

#include <utility>

#include "octavo/core/mapped_words.h"
#include "octavo/core/morton.h"

namespace octavo {

Dag::Dag(int depth, std::vector<std::uint64_t> levels, std::vector<std::uint32_t> words)
    : depth_(depth), levels_(std::move(levels)) {
    auto owned = std::make_shared<const std::vector<std::uint32_t>>(std::move(words));
    words_ = *owned;
    owner_ = std::move(owned);
}

Dag::Dag(int depth, std::vector<std::uint64_t> levels, std::span<const std::uint32_t> words,
         std::shared_ptr<const void> owner, Backing backing)
    : depth_(depth),
      levels_(std::move(levels)),
      words_(words),
      owner_(std::move(owner)),
      backing_(backing) {}

void Dag::release(std::uint64_t first_word, std::uint64_t count) const {
    if (backing_ != Backing::mapped_file) return;
    release_pages(words_.subspan(first_word, count));
}

bool Dag::voxel(const uvec3& voxel) const {
    const std::uint32_t n = resolution();
    if (empty() || voxel.x >= n || voxel.y >= n || voxel.z >= n) return false;

    const std::uint64_t code = morton_encode(voxel);
    std::uint64_t node = 0;
    for (int level = 0; level < leaf_level(); ++level) {
        const int child = static_cast<int>(code >> 3 * (depth_ - 1 - level) & 7u);
        const std::uint32_t mask = words_[node];
        if (!(mask >> child & 1u)) return false;
        node = words_[node + static_cast<unsigned>(child_offset(mask, child))];
    }
    return leaf(node) >> (code & 63u) & 1u;
}

}  // namespace octavo
