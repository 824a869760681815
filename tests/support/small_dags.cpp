// SPDX-License-Identifier: MIT
#include "support/small_dags.h"

#include <cmath>
#include <cstdlib>
#include <random>
#include <utility>

#include "octavo/core/morton.h"

namespace octavo::test {
namespace {

constexpr std::array<std::uint32_t, 8> kNothing{};

uvec3 child_corner(const uvec3& corner, std::uint32_t child_width, unsigned i) {
    return corner + child_width * uvec3(i & 1, i >> 1 & 1, i >> 2);
}

}  // namespace

std::uint32_t SmallDagBuilder::leaf(std::uint64_t voxels) {
    return node(depth_ - 2, {static_cast<std::uint32_t>(voxels),
                             static_cast<std::uint32_t>(voxels >> 32), 0, 0, 0, 0, 0, 0});
}

std::uint32_t SmallDagBuilder::node(int level, const std::array<std::uint32_t, 8>& children) {
    if (children == kNothing) return 0;
    Level& l = levels_[static_cast<std::size_t>(level)];
    const auto [it, is_new] =
        l.numbers.try_emplace(children, static_cast<std::uint32_t>(l.nodes.size()) + 1);
    if (is_new) l.nodes.push_back(children);
    return it->second;
}

Dag SmallDagBuilder::freeze(std::uint32_t root) const {
    if (root == 0) return {depth_, std::vector<std::uint64_t>(levels_.size(), 0), {}};
    const int leaf_level = depth_ - 2;

    // Numbers of each level in the order in which a depth-first walk first meets them.
    std::vector<std::vector<std::uint32_t>> order(levels_.size());
    std::vector<std::vector<std::uint64_t>> word(levels_.size());
    for (std::size_t l = 0; l < levels_.size(); ++l) word[l].assign(levels_[l].nodes.size() + 1, 0);
    const std::function<void(int, std::uint32_t)> meet = [&](int level, std::uint32_t number) {
        const auto l = static_cast<std::size_t>(level);
        if (number == 0 || word[l][number] != 0) return;
        word[l][number] = 1;
        order[l].push_back(number);
        if (level == leaf_level) return;
        for (const std::uint32_t child : levels_[l].nodes[number - 1]) meet(level + 1, child);
    };
    meet(0, root);

    std::vector<std::uint64_t> begins;
    std::uint64_t next = 0;
    for (int level = 0; level <= leaf_level; ++level) {
        const auto l = static_cast<std::size_t>(level);
        begins.push_back(next);
        for (const std::uint32_t number : order[l]) {
            word[l][number] = next;
            next += 1;
            if (level == leaf_level) {
                next += 1;
                continue;
            }
            for (const std::uint32_t child : levels_[l].nodes[number - 1]) next += child != 0;
        }
    }
    begins.push_back(next);

    std::vector<std::uint32_t> words;
    words.reserve(next);
    for (int level = 0; level <= leaf_level; ++level) {
        const auto l = static_cast<std::size_t>(level);
        for (const std::uint32_t number : order[l]) {
            const auto& children = levels_[l].nodes[number - 1];
            if (level == leaf_level) {
                words.insert(words.end(), {children[0], children[1]});
                continue;
            }
            std::uint32_t mask = 0;
            for (unsigned i = 0; i < 8; ++i) mask |= (children[i] != 0 ? 1u : 0u) << i;
            words.push_back(mask);
            for (const std::uint32_t child : children)
                if (child != 0) words.push_back(static_cast<std::uint32_t>(word[l + 1][child]));
        }
    }
    return {depth_, std::move(begins), std::move(words)};
}

Dag dag_of(int depth, const std::function<bool(const uvec3&, std::uint32_t)>& may_hold,
           const std::function<bool(const uvec3&)>& voxel) {
    SmallDagBuilder builder(depth);
    const std::function<std::uint32_t(int, const uvec3&)> build = [&](int level,
                                                                      const uvec3& corner) {
        const std::uint32_t width = 1u << (depth - level);
        if (!may_hold(corner, width)) return 0u;
        if (width == 4) {
            std::uint64_t voxels = 0;
            for (unsigned b = 0; b < 64; ++b)
                voxels |= std::uint64_t{voxel(corner + morton_decode(b))} << b;
            return builder.leaf(voxels);
        }
        std::array<std::uint32_t, 8> children{};
        for (unsigned i = 0; i < 8; ++i)
            children[i] = build(level + 1, child_corner(corner, width / 2, i));
        return builder.node(level, children);
    };
    return builder.freeze(build(0, uvec3(0)));
}

Dag dag_of_distance(int depth, const std::function<double(const dvec3&)>& distance) {
    constexpr double kHalfDiagonal = 0.8660254037844386;
    return dag_of(
        depth,
        [&](const uvec3& corner, std::uint32_t width) {
            return std::abs(distance(dvec3(corner) + 0.5 * width)) <= kHalfDiagonal * (width + 0.1);
        },
        [&](const uvec3& v) { return std::abs(distance(dvec3(v) + 0.5)) <= kHalfDiagonal; });
}

Dag dust(int depth, double density, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    constexpr std::size_t kPerLevel = 48;
    SmallDagBuilder builder(depth);
    std::vector<std::uint32_t> below;
    for (std::size_t i = 0; i < kPerLevel; ++i) {
        std::uint64_t voxels = 0;
        for (int b = 0; b < 64; ++b) voxels |= std::uint64_t{chance(random) < density * 0.6} << b;
        if (const std::uint32_t leaf = builder.leaf(voxels)) below.push_back(leaf);
    }
    for (int level = depth - 3; level >= 0; --level) {
        std::vector<std::uint32_t> nodes;
        for (std::size_t i = 0; i < (level == 0 ? 1 : kPerLevel); ++i) {
            std::array<std::uint32_t, 8> children{};
            for (std::uint32_t& child : children)
                if (!below.empty() && chance(random) < density)
                    child = below[random() % below.size()];
            if (const std::uint32_t node = builder.node(level, children)) nodes.push_back(node);
        }
        below = std::move(nodes);
    }
    return builder.freeze(below.empty() ? 0 : below[0]);
}

Dag full_grid(int depth) {
    std::vector<std::uint32_t> words;
    std::vector<std::uint64_t> levels;
    for (int l = 0; l < depth - 2; ++l) {
        levels.push_back(words.size());
        const auto child = static_cast<std::uint32_t>(words.size()) + 9;
        words.push_back(0xff);
        words.insert(words.end(), 8, child);
    }
    levels.push_back(words.size());
    words.insert(words.end(), 2, 0xffffffffu);
    levels.push_back(words.size());
    return Dag(depth, levels, words);
}

Dag slanted_wall(int depth, const ivec3& a, std::int64_t offset) {
    const std::int64_t thickness = std::abs(a.x) + std::abs(a.y) + std::abs(a.z);
    SmallDagBuilder builder(depth);
    std::map<std::pair<int, std::int64_t>, std::uint32_t>
        done;  // cells with equal offsets are equal
    const auto value = [&](unsigned i) {
        return std::int64_t{a.x} * (i & 1) + std::int64_t{a.y} * (i >> 1 & 1) +
               std::int64_t{a.z} * (i >> 2);
    };
    const std::function<std::uint32_t(int, std::int64_t)> build = [&](int level,
                                                                      std::int64_t from) {
        const std::int64_t last = (std::int64_t{1} << (depth - level)) - 1;
        std::int64_t least = 0;
        std::int64_t most = 0;
        for (int axis = 0; axis < 3; ++axis) (a[axis] < 0 ? least : most) += a[axis] * last;
        if (most < from || least >= from + thickness) return 0u;
        if (const auto it = done.find({level, from}); it != done.end()) return it->second;

        std::uint32_t number = 0;
        if (level == depth - 2) {
            std::uint64_t voxels = 0;
            for (unsigned b = 0; b < 64; ++b) {
                const uvec3 v = morton_decode(b);
                const std::int64_t at = a.x * std::int64_t{v.x} + a.y * std::int64_t{v.y} +
                                        a.z * std::int64_t{v.z} - from;
                voxels |= std::uint64_t{at >= 0 && at < thickness} << b;
            }
            number = builder.leaf(voxels);
        } else {
            std::array<std::uint32_t, 8> children{};
            for (unsigned i = 0; i < 8; ++i)
                children[i] = build(level + 1, from - value(i) * ((last + 1) / 2));
            number = builder.node(level, children);
        }
        return done[{level, from}] = number;
    };
    return builder.freeze(build(0, offset));
}

}  // namespace octavo::test
