// SPDX-License-Identifier: MIT
#include "octavo/render/content_bounds.h"

#include <algorithm>
#include <bit>

namespace octavo {
namespace {

/// Levels below the root down to which the bounds are taken: a 256th of the grid is enough to place
/// a camera, and bounds the work for a DAG whose few nodes stand for very many paths.
constexpr int kFinestLevel = 8;

struct Search {
    const Dag& dag;
    int finest;
    uvec3 low{~0u};
    uvec3 high{0u};

    void visit(std::uint64_t word, std::uint32_t leaf_part, int level, const uvec3& corner) {
        const uvec3 end = corner + (1u << (dag.depth() - level));
        if (glm::all(glm::greaterThanEqual(corner, low)) && glm::all(glm::lessThanEqual(end, high)))
            return;  // nothing in here can widen the bounds
        if (level == finest) {
            low = glm::min(low, corner);
            high = glm::max(high, end);
            return;
        }
        const bool in_leaf = level > dag.leaf_level();
        const std::uint64_t voxels = level == dag.leaf_level() ? dag.leaf(word) : 0;
        const std::uint32_t mask = in_leaf                     ? leaf_part
                                   : level == dag.leaf_level() ? leaf_child_mask(voxels)
                                                               : dag.words()[word] & kChildMaskBits;
        for (std::uint32_t left = mask; left != 0; left &= left - 1) {
            const int i = std::countr_zero(left);
            const auto u = static_cast<unsigned>(i);
            const uvec3 child = corner + (uvec3(u & 1, u >> 1 & 1, u >> 2)
                                          << uvec3(static_cast<unsigned>(dag.depth() - level - 1)));
            const std::uint64_t next =
                level < dag.leaf_level()
                    ? dag.words()[word + static_cast<unsigned>(child_offset(mask, i))]
                    : 0;
            visit(next, static_cast<std::uint32_t>(voxels >> 8 * u & 0xff), level + 1, child);
        }
    }
};

}  // namespace

Box content_bounds(const Dag& dag, const Grid& grid) {
    if (dag.empty()) return {};
    Search search{dag, std::min(dag.depth(), kFinestLevel)};
    search.visit(0, 0, 0, uvec3(0));
    return {grid.to_world(dvec3(search.low)), grid.to_world(dvec3(search.high))};
}

Box framed_box(const Dag& dag, const Grid& grid) {
    const Box content = content_bounds(dag, grid);
    return content.empty() ? grid.bounds() : content;
}

}  // namespace octavo
