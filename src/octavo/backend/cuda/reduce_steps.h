// SPDX-License-Identifier: MIT
//
// The leaves of a tile become unique nodes, all levels, in steps that each do many small things at
// once: [K13] section 3 ("all parts of the compaction could be performed in parallel"). Every step
// is a function object for one element, which CUDA runs for all of them and which tests run in a
// loop; the sort and the scans come from whoever runs it.
//
// Nodes keep the order in which the tree first meets them, so the bytes are those of
// construct/reduce.h: sorting by hash is stable, so the first of equal nodes stays the first, and
// ids are given out in the old order.
#pragma once

#include <cstdint>

#include "octavo/dag/node.h"
#include "octavo/trace/shared_text.h"

namespace octavo::cuda {

/// A node as it is before it is known to be new: a leaf's two halves, or a mask and children's ids;
/// the rest zero.
struct Candidate {
    std::uint32_t words[kMaxNodeWords];
};

OCTAVO_FN bool equal(const Candidate& a, const Candidate& b) {
    for (int i = 0; i < kMaxNodeWords; ++i)
        if (a.words[i] != b.words[i]) return false;
    return true;
}

OCTAVO_FN std::uint64_t hash_of(const Candidate& node) {
    std::uint64_t hash = 0;
    for (const std::uint32_t word : node.words) {
        hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    return hash;
}

OCTAVO_FN std::uint32_t words_of(const Candidate& node, bool leaf) {
    if (leaf) return kLeafWords;
    return 1u + static_cast<std::uint32_t>(shared::count_bits8(node.words[0] & kChildMaskBits));
}

/// One level's arrays; n candidates.
struct LevelArrays {
    std::uint32_t n;
    bool leaves;
    const std::uint32_t* codes;  // Morton codes of the candidates' cells
    const Candidate* nodes;
    std::uint64_t* hashes;          // then sorted
    std::uint32_t* order;           // candidates by hash, stable
    std::uint32_t* run_begin;       // for place k of order: the first place with its hash
    std::uint32_t* representative;  // for candidate i: the first candidate that equals it
    std::uint32_t* sizes;           // words of candidate i if it is the first of its equals, else 0
    std::uint32_t* offsets;         // sum of the sizes before; the id, where it is the first
    std::uint32_t* ids;             // for candidate i
    std::uint32_t* words;           // out: the unique nodes, one after the other
};

struct HashStep {
    LevelArrays level;
    OCTAVO_FN void operator()(std::uint32_t i) const {
        level.hashes[i] = hash_of(level.nodes[i]);
        level.order[i] = i;
    }
};

/// Before a running maximum: place k where a run of equal hashes begins, else 0.
struct RunStep {
    LevelArrays level;
    OCTAVO_FN void operator()(std::uint32_t k) const {
        level.run_begin[k] = k > 0 && level.hashes[k] != level.hashes[k - 1] ? k : 0;
    }
};

/// Different nodes may have one hash: the first of a run that is equal counts, nearly always the
/// run's first.
struct MatchStep {
    LevelArrays level;
    OCTAVO_FN void operator()(std::uint32_t k) const {
        const std::uint32_t i = level.order[k];
        std::uint32_t first = level.run_begin[k];
        while (!equal(level.nodes[level.order[first]], level.nodes[i])) ++first;
        level.representative[i] = level.order[first];
    }
};

struct SizeStep {
    LevelArrays level;
    OCTAVO_FN void operator()(std::uint32_t i) const {
        level.sizes[i] = level.representative[i] == i ? words_of(level.nodes[i], level.leaves) : 0;
    }
};

struct WriteStep {
    LevelArrays level;
    OCTAVO_FN void operator()(std::uint32_t i) const {
        level.ids[i] = level.offsets[level.representative[i]];
        for (std::uint32_t w = 0; w < level.sizes[i]; ++w)
            level.words[level.offsets[i] + w] = level.nodes[i].words[w];
    }
};

/// 1 where a cell is the first of its parent's children.
struct FirstChildStep {
    LevelArrays level;
    std::uint32_t* first;
    OCTAVO_FN void operator()(std::uint32_t i) const {
        first[i] = i == 0 || level.codes[i] >> 3 != level.codes[i - 1] >> 3 ? 1 : 0;
    }
};

/// After the sum of those before each: the first child puts its parent together.
struct ParentStep {
    LevelArrays level;
    const std::uint32_t* first;
    const std::uint32_t* parents_before;
    Candidate* parents;
    std::uint32_t* parent_codes;
    OCTAVO_FN void operator()(std::uint32_t i) const {
        if (first[i] == 0) return;
        const std::uint32_t code = level.codes[i] >> 3;
        Candidate parent{};
        int size = 1;
        for (std::uint32_t k = i; k < level.n && level.codes[k] >> 3 == code; ++k) {
            parent.words[0] |= 1u << (level.codes[k] & 7u);
            parent.words[size++] = level.ids[k];
        }
        parents[parents_before[i]] = parent;
        parent_codes[parents_before[i]] = code;
    }
};

/// Reduces a tile's leaves level by level.
///
/// `Runner` has, in memory of its own that stays until the next call for the same `use`:
///     T* array<T>(use, n)
///     void for_each(n, step)
///     void sort(hashes, order, n)          both by hash, stable
///     void running_maximum(values, n)
///     void sum_before(in, out, n)
///     std::uint32_t value(address)         on the host
///
/// @param leaves  candidates and codes of the n leaves in Morton order, n > 0
/// @param take    take(height, words, count of words, nodes), for height 0 to top
template <typename Runner, typename Take>
void reduce_tile(Runner& run, const std::uint32_t* leaf_codes, const Candidate* leaves,
                 std::uint32_t n, int top, const Take& take) {
    const std::uint32_t* codes = leaf_codes;
    const Candidate* nodes = leaves;
    for (int height = 0; height <= top; ++height) {
        LevelArrays level{n,
                          height == 0,
                          codes,
                          nodes,
                          run.template array<std::uint64_t>("hashes", n),
                          run.template array<std::uint32_t>("order", n),
                          run.template array<std::uint32_t>("run_begin", n),
                          run.template array<std::uint32_t>("representative", n),
                          run.template array<std::uint32_t>("sizes", n),
                          run.template array<std::uint32_t>("offsets", n),
                          run.template array<std::uint32_t>("ids", n),
                          nullptr};
        run.for_each(n, HashStep{level});
        run.sort(level.hashes, level.order, n);
        run.for_each(n, RunStep{level});
        run.running_maximum(level.run_begin, n);
        run.for_each(n, MatchStep{level});
        run.for_each(n, SizeStep{level});
        run.sum_before(level.sizes, level.offsets, n);
        const std::uint32_t words =
            run.value(level.offsets + n - 1) + run.value(level.sizes + n - 1);
        level.words = run.template array<std::uint32_t>("words", words);
        run.for_each(n, WriteStep{level});
        take(height, level.words, words);
        if (height == top) return;

        auto* first = run.template array<std::uint32_t>("first", n);
        auto* before = run.template array<std::uint32_t>("before", n);
        run.for_each(n, FirstChildStep{level, first});
        run.sum_before(first, before, n);
        const std::uint32_t parents = run.value(before + n - 1) + run.value(first + n - 1);
        // Two of each, in turn: one level's cells are read while the next one's are written.
        auto* parent_nodes =
            run.template array<Candidate>(height % 2 == 0 ? "even nodes" : "odd nodes", parents);
        auto* parent_codes = run.template array<std::uint32_t>(
            height % 2 == 0 ? "even codes" : "odd codes", parents);
        run.for_each(n, ParentStep{level, first, before, parent_nodes, parent_codes});
        codes = parent_codes;
        nodes = parent_nodes;
        n = parents;
    }
}

}  // namespace octavo::cuda
