// SPDX-License-Identifier: MIT
#include "octavo/construct/journal.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <fstream>

#include "octavo/construct/build.h"
#include "support/random_scene.h"
#include "support/temporary_folder.h"

namespace octavo {
namespace {

using test::TemporaryFolder;

constexpr std::uint64_t kStopAt = 20;  // tiles

BuildOptions with_journal(const std::filesystem::path& file) {
    BuildOptions options;
    options.depth = 8;
    options.tile = 32;
    options.journal = file;
    options.journal_interval = std::chrono::milliseconds(0);
    return options;
}

bool same_words(const Dag& a, const Dag& b) {
    return std::ranges::equal(a.words(), b.words()) &&
           std::ranges::equal(a.level_begins(), b.level_begins());
}

/// Leaves a journal of the first tiles behind.
void build_and_stop(const Scene& scene, BuildOptions options) {
    options.progress = [](const Progress& p) { return p.done < kStopAt; };
    try {
        (void)build(scene, options);
        FAIL() << "it went on to the end";
    } catch (const Error& e) {
        ASSERT_EQ(e.code(), Errc::cancelled);
    }
}

/// Builds to the end; says which tile was the first to be merged.
BuildResult build_on(const Scene& scene, BuildOptions options, std::uint64_t& first_tile) {
    first_tile = 0;
    options.progress = [&](const Progress& p) {
        if (first_tile == 0) first_tile = p.done;
        return true;
    };
    return build(scene, options);
}

TEST(Journal, AStoppedBuildGoesOnAndEndsInTheSameWords) {
    const TemporaryFolder folder;
    const Scene scene = test::random_scene(31, 300);
    const BuildOptions options = with_journal(folder / "j");
    build_and_stop(scene, options);
    ASSERT_TRUE(std::filesystem::exists(options.journal));

    std::uint64_t first_tile = 0;
    const BuildResult went_on = build_on(scene, options, first_tile);
    EXPECT_EQ(first_tile, kStopAt + 1);
    BuildOptions without;
    without.depth = 8;
    EXPECT_TRUE(same_words(went_on.dag, build(scene, without).dag));
    EXPECT_FALSE(std::filesystem::exists(options.journal));
}

TEST(Journal, ATornOrDamagedEndCostsOnlyItself) {
    const TemporaryFolder folder;
    const Scene scene = test::random_scene(32, 200);
    BuildOptions without;
    without.depth = 8;
    const Dag expected = build(scene, without).dag;
    const BuildOptions options = with_journal(folder / "j");
    build_and_stop(scene, options);
    const std::string whole = test::file_content(options.journal);

    std::uint64_t first_tile = 0;
    for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 40) {
        std::ofstream(options.journal, std::ios::binary) << whole.substr(0, size);
        EXPECT_TRUE(same_words(build_on(scene, options, first_tile).dag, expected)) << size;
        EXPECT_LE(first_tile, kStopAt);

        std::string damaged = whole;
        damaged[size] = static_cast<char>(damaged[size] ^ 0x10);
        std::ofstream(options.journal, std::ios::binary) << damaged;
        EXPECT_TRUE(same_words(build_on(scene, options, first_tile).dag, expected)) << size;
        EXPECT_LE(first_tile, kStopAt);
    }
}

TEST(Journal, OfAnotherSceneOrGridIsNotContinued) {
    const TemporaryFolder folder;
    const BuildOptions options = with_journal(folder / "j");
    build_and_stop(test::random_scene(33, 200), options);
    const Scene other = test::random_scene(34, 200);
    std::uint64_t first_tile = 0;
    const BuildResult built = build_on(other, options, first_tile);
    EXPECT_EQ(first_tile, 1u);
    BuildOptions without;
    without.depth = 8;
    EXPECT_TRUE(same_words(built.dag, build(other, without).dag));
}

TEST(Journal, ABuildWithoutTimeForACheckpointLeavesNoFile) {
    const TemporaryFolder folder;
    BuildOptions options = with_journal(folder / "j");
    options.journal_interval = std::chrono::hours(1);
    (void)build(test::random_scene(35, 100), options);
    EXPECT_FALSE(std::filesystem::exists(options.journal));
}

TEST(Journal, CannotBeWrittenByTwoBuildsAtOnce) {
    const TemporaryFolder folder;
    NodeStore store(2);
    ConstructState state;
    Journal first(folder / "j", 1);
    first.restore(store, state);
    first.checkpoint(store, state);
    Journal second(folder / "j", 1);
    EXPECT_THROW(second.restore(store, state), Error);
}

TEST(Journal, ADiskThatTakesNoMoreIsAnErrorThatNamesTheFile) {
    const TemporaryFolder folder;
    // A limit on file sizes fails a write half-way, as a full disk does.
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit small{4096, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    try {
        (void)build(test::random_scene(36, 200), with_journal(folder / "j"));
        ADD_FAILURE() << "nothing was said";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::io);
        EXPECT_EQ(e.file(), folder / "j");
    }
    setrlimit(RLIMIT_FSIZE, &before);
}

}  // namespace
}  // namespace octavo
