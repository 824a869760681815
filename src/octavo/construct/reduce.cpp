// SPDX-License-Identifier: MIT
#include "octavo/construct/reduce.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <vector>

#include "octavo/voxelize/leaf_vectors.h"

namespace octavo {

void reduce_level(NodeStore& store, int height, std::vector<CellNode>& cells) {
    UniqueNodes& nodes = store.level(height);
    std::size_t parents = 0;
    for (std::size_t i = 0; i < cells.size();) {
        const std::uint32_t parent = cells[i].code >> 3;
        std::uint32_t words[kMaxNodeWords] = {};
        int size = 1;
        for (; i < cells.size() && cells[i].code >> 3 == parent; ++i) {
            words[0] |= 1u << (cells[i].code & 7u);
            words[size++] = cells[i].node;
        }
        cells[parents++] = {parent, nodes.add(words)};
    }
    cells.resize(parents);
}

void reduce_upwards(NodeStore& store, int from_height, std::vector<CellNode>& cells,
                    OctreeCounts& counts) {
    for (int height = from_height; height <= store.top(); ++height) {
        reduce_level(store, height, cells);
        counts.at_height(height) += cells.size();
    }
}

namespace {

/// Leaves to their ids.
class LeafReducer {
public:
    LeafReducer(UniqueNodes& leaves, ReduceScratch& scratch) : leaves_(leaves), scratch_(scratch) {
        scratch.recent_leaves.fill(0);  // no leaf is 0
    }

    [[nodiscard]] std::uint32_t id_of(std::uint64_t leaf) {
        const std::uint64_t hash = UniqueNodes::hash_leaf(leaf);
        const std::size_t place = hash % ReduceScratch::kRecent;
        if (scratch_.recent_leaves[place] != leaf) {
            scratch_.recent_leaves[place] = leaf;
            scratch_.recent_ids[place] = leaves_.add_leaf(leaf, hash);
        }
        return scratch_.recent_ids[place];
    }

private:
    UniqueNodes& leaves_;
    ReduceScratch& scratch_;
};

/// Finds the nodes of height 1 by their leaves, as long as that is worth it.
///
/// @param nodes  their ids, in order
/// @return       how many of them are found
std::size_t find_parents(UniqueNodes& parents, LeafReducer& reducer, RecentParents& recent,
                         const TileOctree& octree, std::uint32_t* nodes) {
    const std::vector<std::uint8_t>& masks = octree.child_masks(1);
    const std::uint64_t* leaves = octree.leaves.data();
    const std::uint64_t* const end = leaves + octree.leaves.size();
    recent.clear();
    std::size_t i = 0;
    for (; i < masks.size() && recent.worth_asking(); ++i) {
        const std::uint32_t mask = masks[i];
        const int count = std::popcount(mask);
        const auto add = [&] {
            std::uint32_t ids[8] = {};
            for (int k = 0; k < count; ++k) ids[k] = reducer.id_of(leaves[k]);
            return parents.add_interior(mask, ids);
        };
        nodes[i] = count <= Siblings::kMost && end - leaves >= Siblings::kMost
                       ? recent.find(mask, Siblings::first_of(leaves, count), add)
                       : add();
        leaves += count;
    }
    return i;
}

/// Leaves to their ids, a batch at a time: first all are looked for without a branch on whether
/// they are there, which can hardly be foretold, and then those that were not seen are added, in
/// order. Where most are new, that can be foretold, and they are added at once.
void reduce_leaves(UniqueNodes& level, std::span<const std::uint64_t> leaves,
                   std::uint32_t* nodes) {
    constexpr std::size_t kBatch = 64;
    constexpr std::size_t kMostlyNew = kBatch * 5 / 8;
    constexpr int kBatchesAtOnce = 7;  // after one that was mostly new
    std::array<std::uint64_t, kBatch> hashes;
    std::array<std::uint8_t, kBatch> unseen;
    int at_once = 0;
    while (!leaves.empty()) {
        const auto batch = leaves.first(std::min(kBatch, leaves.size()));
        if (at_once > 0) {
            --at_once;
            for (std::size_t i = 0; i < batch.size(); ++i) nodes[i] = level.add_leaf(batch[i]);
        } else {
            std::size_t count = 0;
            for (std::size_t i = 0; i < batch.size(); ++i) {
                hashes[i] = UniqueNodes::hash_leaf(batch[i]);
                const Glance glance = level.glance_leaf(batch[i], hashes[i]);
                nodes[i] = glance.id;
                unseen[count] = static_cast<std::uint8_t>(i);
                count += !glance.seen;
            }
            for (std::size_t k = 0; k < count; ++k)
                nodes[unseen[k]] = level.add_leaf(batch[unseen[k]], hashes[unseen[k]]);
            if (count > kMostlyNew) at_once = kBatchesAtOnce;
        }
        leaves = leaves.subspan(batch.size());
        nodes += batch.size();
    }
}

/// Puts nodes in place of their children, from this one on.
void reduce_children(UniqueNodes& level, std::span<const std::uint8_t> masks,
                     const std::uint32_t* children, std::uint32_t* nodes) {
    for (const std::uint32_t mask : masks) {
        const int size = std::popcount(mask);
        *nodes++ = level.add_interior(mask, children);
        children += size;
    }
}

}  // namespace

// As reduce_upwards(), but for the small tables of a tile: what costs is not memory but branches
// that go either way, so there are few.
void reduce_tile(NodeStore& store, const TileOctree& octree, ReduceScratch& scratch) {
    // Children are read eight at a time.
    if (scratch.nodes.size() < octree.leaves.size() + 8)
        scratch.nodes.resize(octree.leaves.size() + 8);

    std::uint32_t* const nodes = scratch.nodes.data();

    std::size_t parents = 0, leaves = 0;  // done
    if (store.top() > 0) {
        LeafReducer reducer(store.level(0), scratch);
        parents = find_parents(store.level(1), reducer, scratch.recent_parents, octree, nodes);
        for (std::size_t i = 0; i < parents; ++i)
            leaves += static_cast<unsigned>(std::popcount(octree.child_masks(1)[i]));
    }
    reduce_leaves(store.level(0), std::span(octree.leaves).subspan(leaves), nodes + leaves);
    for (int height = 1; height <= store.top(); ++height) {
        const std::size_t done = height == 1 ? parents : 0;
        reduce_children(store.level(height), std::span(octree.child_masks(height)).subspan(done),
                        nodes + (height == 1 ? leaves : 0), nodes + done);
    }
}

void count_cells(const TileOctree& octree, int top, OctreeCounts& counts) {
    const LeafCounts leaves = count_leaves(octree.leaves);
    counts.voxels += leaves.voxels;
    counts.cells[0] += leaves.children;
    for (int height = 0; height <= top; ++height) counts.at_height(height) += octree.count(height);
}

}  // namespace octavo
