// SPDX-License-Identifier: MIT
// The quick check against the one that says what is wrong.
#include "octavo/io/sound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string_view>
#include <vector>

#include "octavo/construct/build.h"
#include "octavo/io/check.h"
#include "octavo/mesh/samples.h"
#include "octavo/voxelize/tile_rasterizer.h"

namespace octavo {
namespace {

/// Levels of more and of fewer words than a group and a part of the quick check have.
const Dag& courtyard() {
    static const Dag kDag = [] {
        BuildOptions options;
        options.depth = 9;
        return build(make_sample("courtyard", 0.2), options).dag;
    }();
    return kDag;
}

struct Words {
    std::vector<std::uint64_t> begins;
    std::vector<std::uint32_t> words;

    explicit Words(const Dag& dag)
        : begins(dag.level_begins().begin(), dag.level_begins().end()),
          words(dag.words().begin(), dag.words().end()) {}

    [[nodiscard]] std::optional<std::uint64_t> quick() const {
        return voxels_if_sound(begins, words, {});
    }
    /// What the slow check says, which the quick one does not stand in front of where it is strict.
    [[nodiscard]] bool slow() const {
        static constexpr std::array<std::string_view, 3> kHarmless = {
            "node-duplicate", "node-order", "node-unreachable"};
        return std::ranges::all_of(
            find_faults(begins, words, {}, {.strict = true, .max_faults = 100}),
            [&](const DagFault& fault) {
                return std::ranges::find(kHarmless, fault.code) != kHarmless.end();
            });
    }
};

TEST(VoxelsIfSound, CountsTheVoxelsOfASoundDag) {
    const Words dag(courtyard());
    const Statistics statistics = compute_statistics(courtyard());
    EXPECT_EQ(dag.quick(), statistics.voxels);
    std::vector<std::uint64_t> nodes;
    for (const LevelStatistics& level : statistics.levels) nodes.push_back(level.dag_nodes);
    nodes.resize(dag.begins.size() - 1);
    EXPECT_EQ(voxels_if_sound(dag.begins, dag.words, nodes), statistics.voxels);
    for (std::uint64_t& count : nodes) {
        ++count;
        EXPECT_EQ(voxels_if_sound(dag.begins, dag.words, nodes), std::nullopt);
        --count;
    }
}

/// A word becomes one that is likely to be nearly right: another pointer, a mask, one more or less.
std::uint32_t nearly(const std::vector<std::uint32_t>& words, std::size_t at,
                     std::mt19937& random) {
    const std::array<std::uint32_t, 8> choices = {
        words[at] + 1,
        words[at] - 1,
        words[at] + 2,
        words[at] ^ (1u << random() % 32),
        static_cast<std::uint32_t>(random() % 256),
        static_cast<std::uint32_t>(random() % (words.size() + 2)),
        words[random() % words.size()],
        at + 1 < words.size() ? words[at + 1] : 0u};
    return choices[random() % choices.size()];
}

TEST(VoxelsIfSound, AgreesWithTheSlowCheckOnChangedWordsOnEverySimdTarget) {
    Words dag(courtyard());
    for (const char* target : simd_targets()) {
        force_simd_target(target);
        std::mt19937 random(7);
        int refused = 0, taken = 0;
        for (int i = 0; i < 150; ++i) {
            // Small levels are as likely as large ones.
            const std::size_t level = random() % (dag.begins.size() - 1);
            const std::uint64_t size = dag.begins[level + 1] - dag.begins[level];
            const std::size_t at = dag.begins[level] + random() % size;
            const std::uint32_t old = dag.words[at];
            dag.words[at] = nearly(dag.words, at, random);
            const bool sound = dag.slow();
            (sound ? taken : refused) += 1;
            ASSERT_EQ(dag.quick().has_value(), sound)
                << target << ": word " << at << " of level " << level << ", " << old << " to "
                << dag.words[at];
            dag.words[at] = old;
        }
        EXPECT_GT(refused, 30);
        EXPECT_GT(taken, 10);
    }
    force_simd_target(nullptr);
}

TEST(VoxelsIfSound, RefusesLevelsThatEndInTheMiddleOfANode) {
    const Words dag(courtyard());
    for (std::size_t level = 1; level + 1 < dag.begins.size(); ++level) {
        for (const int step : {-1, 1}) {
            Words moved = dag;
            moved.begins[level] += static_cast<std::uint64_t>(step);
            EXPECT_FALSE(moved.slow());
            EXPECT_EQ(moved.quick(), std::nullopt) << "level " << level;
        }
    }
}

}  // namespace
}  // namespace octavo
