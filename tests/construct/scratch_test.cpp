// SPDX-License-Identifier: MIT
#include "octavo/construct/scratch.h"

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

BuildOptions with_scratch(const std::filesystem::path& folder) {
    BuildOptions options;
    options.depth = 8;
    options.tile = 32;
    options.scratch = folder;
    options.journal_interval = std::chrono::milliseconds(0);
    return options;
}

bool same_words(const Dag& a, const Dag& b) {
    return std::ranges::equal(a.words(), b.words()) &&
           std::ranges::equal(a.level_begins(), b.level_begins());
}

/// Leaves a scratch with the first tiles behind.
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

std::filesystem::path only_part(const std::filesystem::path& scratch) {
    for (const auto& entry : std::filesystem::directory_iterator(scratch))
        if (entry.path().filename().string().starts_with("part-")) return entry.path();
    return {};
}

/// Makes a scratch whose one part has this content.
void leave(const std::filesystem::path& scratch, const std::string& content) {
    std::filesystem::create_directory(scratch);
    test::write_file(scratch / "part-0000000000", content);
}

TEST(Scratch, AStoppedBuildGoesOnAndEndsInTheSameWords) {
    const TemporaryFolder folder;
    const Scene scene = test::random_scene(31, 300);
    const BuildOptions options = with_scratch(folder / "j");
    build_and_stop(scene, options);
    ASSERT_TRUE(std::filesystem::exists(options.scratch));

    std::uint64_t first_tile = 0;
    const BuildResult went_on = build_on(scene, options, first_tile);
    EXPECT_EQ(first_tile, kStopAt + 1);
    BuildOptions without;
    without.depth = 8;
    EXPECT_TRUE(same_words(went_on.dag, build(scene, without).dag));
    EXPECT_FALSE(std::filesystem::exists(options.scratch));
}

TEST(Scratch, ATornOrDamagedEndCostsOnlyItself) {
    const TemporaryFolder folder;
    const Scene scene = test::random_scene(32, 200);
    BuildOptions without;
    without.depth = 8;
    const Dag expected = build(scene, without).dag;
    const BuildOptions options = with_scratch(folder / "j");
    build_and_stop(scene, options);
    const std::string whole = test::file_content(only_part(options.scratch));

    std::uint64_t first_tile = 0;
    for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 40) {
        leave(options.scratch, whole.substr(0, size));
        EXPECT_TRUE(same_words(build_on(scene, options, first_tile).dag, expected)) << size;
        EXPECT_LE(first_tile, kStopAt);

        std::string damaged = whole;
        damaged[size] = static_cast<char>(damaged[size] ^ 0x10);
        leave(options.scratch, damaged);
        EXPECT_TRUE(same_words(build_on(scene, options, first_tile).dag, expected)) << size;
        EXPECT_LE(first_tile, kStopAt);
    }
}

TEST(Scratch, OfAnotherSceneOrGridIsNotContinued) {
    const TemporaryFolder folder;
    const BuildOptions options = with_scratch(folder / "j");
    build_and_stop(test::random_scene(33, 200), options);
    const Scene other = test::random_scene(34, 200);
    std::uint64_t first_tile = 0;
    const BuildResult built = build_on(other, options, first_tile);
    EXPECT_EQ(first_tile, 1u);
    BuildOptions without;
    without.depth = 8;
    EXPECT_TRUE(same_words(built.dag, build(other, without).dag));
}

TEST(Scratch, ABuildWithoutTimeForACheckpointLeavesNothing) {
    const TemporaryFolder folder;
    BuildOptions options = with_scratch(folder / "j");
    options.journal_interval = std::chrono::hours(1);
    (void)build(test::random_scene(35, 100), options);
    EXPECT_FALSE(std::filesystem::exists(options.scratch));
}

TEST(Scratch, CannotBeUsedByTwoBuildsAtOnce) {
    const TemporaryFolder folder;
    Scratch first(folder / "s", 1, 2);
    first.open();
    Scratch second(folder / "s", 1, 2);
    EXPECT_THROW(second.open(), Error);
    EXPECT_THROW((void)second.take_parts(), Error);
}

TEST(Scratch, LeavesAloneWhatABuildDidNotMake) {
    const TemporaryFolder folder;
    const BuildOptions options = with_scratch(folder / "s");
    build_and_stop(test::random_scene(37, 100), options);
    test::write_file(options.scratch / "holiday.jpg", "precious");
    (void)build(test::random_scene(37, 100), options);
    EXPECT_EQ(test::file_content(options.scratch / "holiday.jpg"), "precious");
    EXPECT_TRUE(only_part(options.scratch).empty());
}

/// Stops a build that spills in each of its phases in turn, again and again.
TEST(Scratch, ABuildThatSpillsGoesOnWhereverItWasStopped) {
    const TemporaryFolder folder;
    const Scene scene = test::random_scene(38, 300);
    BuildOptions without;
    without.depth = 8;
    const Dag expected = build(scene, without).dag;
    BuildOptions options = with_scratch(folder / "s");
    options.spill = {.node_bytes = 50'000, .triangle_bytes = 50'000};
    int stops = 0;
    std::vector<std::string> stopped_in;
    for (;; ++stops) {
        ASSERT_LT(stops, 1000) << "it does not come nearer to its end";
        // One report further each time.
        int reports = 0;
        options.progress = [&](const Progress& p) {
            if (++reports <= 2 * stops + 3) return true;
            if (stopped_in.empty() || stopped_in.back() != p.phase)
                stopped_in.emplace_back(p.phase);
            return false;
        };
        try {
            EXPECT_TRUE(same_words(build(scene, options).dag, expected));
            break;
        } catch (const Error& e) {
            ASSERT_EQ(e.code(), Errc::cancelled) << e.what();
        }
    }
    for (const char* phase : {"voxelize", "freeze"})
        EXPECT_TRUE(std::ranges::find(stopped_in, phase) != stopped_in.end()) << phase;
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Scratch, ADiskThatTakesNoMoreIsAnErrorThatNamesTheFile) {
    const TemporaryFolder folder;
    // A limit on file sizes fails a write half-way, as a full disk does.
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit small{4096, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    try {
        (void)build(test::random_scene(36, 200), with_scratch(folder / "j"));
        ADD_FAILURE() << "nothing was said";
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), Errc::io);
        EXPECT_EQ(e.file().parent_path(), folder / "j");
        EXPECT_NE(std::string(e.what()).find(" bytes"), std::string::npos) << e.what();
    }
    setrlimit(RLIMIT_FSIZE, &before);
}

}  // namespace
}  // namespace octavo
