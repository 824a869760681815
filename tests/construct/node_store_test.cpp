// SPDX-License-Identifier: MIT
#include "octavo/construct/node_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <vector>

#include "octavo/core/parallel.h"

namespace octavo {
namespace {

/// So many nodes that a level is cut for the threads, and given back in more than one step.
NodeStore large_store(std::vector<std::vector<std::uint32_t>>& words) {
    std::mt19937_64 random(7);
    NodeStore store(2);
    std::vector<std::uint32_t> leaves, nodes;
    for (std::uint32_t i = 0; i < 100'000; ++i) leaves.push_back(store.level(0).add_leaf(i + 1));
    for (int i = 0; i < 1'000'000; ++i) {
        const auto mask = static_cast<std::uint32_t>(1 + random() % 255);
        std::uint32_t children[8];
        for (std::uint32_t& child : children) child = leaves[random() % leaves.size()];
        nodes.push_back(store.level(1).add_interior(mask, children));
    }
    store.level(2).add_interior(255, nodes.data());
    for (int h = 0; h <= 2; ++h) {
        const auto of_level = store.level(h).words();
        words.emplace_back(of_level.begin(), of_level.end());
    }
    return store;
}

TEST(NodeStore, FreezesToTheSameWordsWithAnyNumberOfThreads) {
    for (const int threads : {1, 2, 5}) {
        std::vector<std::vector<std::uint32_t>> words;
        NodeStore store = large_store(words);
        Dag dag;
        with_threads(threads, [&] { dag = std::move(store).freeze(4); });

        std::vector<std::uint32_t> expected;
        for (int h = 2; h >= 0; --h) {
            const std::vector<std::uint32_t>& level = words[static_cast<unsigned>(h)];
            const auto next = static_cast<std::uint32_t>(expected.size() + level.size());
            for (std::size_t i = 0; h > 0 && i < level.size();) {
                const int children = std::popcount(level[i] & 255u);
                expected.push_back(level[i++]);
                for (int k = 0; k < children; ++k) expected.push_back(level[i++] + next);
            }
            if (h == 0) expected.insert(expected.end(), level.begin(), level.end());
        }
        ASSERT_EQ(dag.words().size(), expected.size());
        EXPECT_TRUE(std::ranges::equal(dag.words(), expected)) << threads << " threads";
    }
}

TEST(NodeStore, MergesWhatItTookAsItWouldThePartItself) {
    const auto part = [](std::uint32_t first) {
        NodeStore store(1);
        std::uint32_t children[8];
        for (std::uint32_t k = 0; k < 8; ++k) children[k] = store.level(0).add_leaf(first + k);
        store.level(1).add_interior(255, children);
        return store;
    };
    NodeStore direct(1), taken(1), worker(1), waiting(1);
    for (const std::uint32_t first : {1u, 5u, 1u, 90u}) {
        const std::uint32_t id = direct.merge_root(part(first));
        for (std::uint32_t k = 0; k < 8; ++k) worker.level(0).add_leaf(first + k);
        std::uint32_t children[8];
        for (std::uint32_t k = 0; k < 8; ++k) children[k] = 2 * k;
        worker.level(1).add_interior(255, children);
        waiting.take(worker);
        EXPECT_EQ(worker.level(0).count(), 0u);
        EXPECT_EQ(taken.merge_root(waiting), id);
    }
    for (int h = 0; h <= 1; ++h)
        EXPECT_TRUE(std::ranges::equal(taken.level(h).words(), direct.level(h).words()));
}

}  // namespace
}  // namespace octavo
