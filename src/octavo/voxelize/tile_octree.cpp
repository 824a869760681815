// SPDX-License-Identifier: MIT
#include "octavo/voxelize/tile_octree.h"

namespace octavo {

TileOctree octree_of(std::span<const LeafBlock> blocks, int top) {
    TileOctree octree;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        octree.leaves.push_back(blocks[i].voxels);
        for (int height = 1; height <= top; ++height) {
            const auto node_of = [&](std::size_t k) { return blocks[k].code >> 3 * height; };
            if (i == 0 || node_of(i) != node_of(i - 1)) octree.child_masks(height).push_back(0);
            const std::uint32_t child = blocks[i].code >> 3 * (height - 1) & 7u;
            octree.child_masks(height).back() |= static_cast<std::uint8_t>(1u << child);
        }
    }
    return octree;
}

std::vector<LeafBlock> blocks_of(const TileOctree& octree, int top) {
    if (octree.empty()) return {};
    std::vector<std::uint32_t> codes = {0};
    for (int height = top; height > 0; --height) {
        std::vector<std::uint32_t> below;
        for (std::size_t i = 0; i < codes.size(); ++i)
            for (std::uint32_t child = 0; child < 8; ++child)
                if (octree.child_masks(height)[i] >> child & 1u)
                    below.push_back(codes[i] << 3 | child);
        codes = std::move(below);
    }
    std::vector<LeafBlock> blocks;
    for (std::size_t i = 0; i < codes.size(); ++i) blocks.push_back({octree.leaves[i], codes[i]});
    return blocks;
}

}  // namespace octavo
