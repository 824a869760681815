// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <sstream>

#include "cli/run_command.h"
#include "support/sanitized.h"

namespace octavo::test {
namespace {

using Json = nlohmann::json;

std::uintmax_t scratch_bytes(const std::filesystem::path& folder) {
    std::uintmax_t bytes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) bytes += entry.file_size();
    return bytes;
}

/// Sends a signal to a build that would take minutes, once it has worked for a while.
struct Interrupted {
    int code = 0;
    double seconds = 0.0;  // from the signal to the end
    std::string err;
};
Interrupted interrupt(const TemporaryFolder& folder, const std::string& signal) {
    const Outcome outcome = run_shell(
        folder.path(),
        "octavo build sample:hairball -o a.octv -r 16K --journal-seconds 0.1 2>err & pid=$!\n"
        "for i in $(seq 600); do grep -q voxelize err && break; sleep 0.1; done; sleep 2\n"
        "begin=$(date +%s%N); kill -" +
            signal +
            " $pid; wait $pid; code=$?; end=$(date +%s%N)\n"
            "echo $((end - begin)); cat err >&2; rm err; exit $code");
    return {outcome.code, 1e-9 * std::stod(outcome.out), outcome.err};
}

TEST(InterruptSlow, EndsABuildInGoodOrderWithinASecond) {
    for (const auto& [signal, code] : {std::pair("INT", 130), std::pair("TERM", 143)}) {
        const TemporaryFolder folder;
        const Interrupted found = interrupt(folder, signal);
        EXPECT_EQ(found.code, code) << found.err;
        EXPECT_NE(found.err.find("octavo: "), std::string::npos) << found.err;
        EXPECT_LT(found.seconds, kSanitized ? 60.0 : 1.0);
        EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.octv"));
        // The scratch, and nothing else: the same command goes on from it.
        EXPECT_TRUE(std::filesystem::exists(folder.path() / "a.octv.scratch"));
        EXPECT_EQ(folder.entries(), 1u);
        EXPECT_GT(scratch_bytes(folder.path() / "a.octv.scratch"), 0u);
    }
}

/// The tiles that a build had done when it finished its first one: 1 where it began from nothing;
/// none where it found all of them done.
std::optional<std::uint64_t> first_done(const std::string& err) {
    std::istringstream lines(err);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with('{')) continue;
        const Json json = Json::parse(line);
        if (json.at("phase") == "voxelize" && json.contains("done"))
            return json.at("done").get<std::uint64_t>();
    }
    return std::nullopt;
}

/// Kills a build a few times, always before it could have been done, then lets it go on to the end.
void kill_and_go_on(const std::string& options) {
    const TemporaryFolder folder;
    const std::string build = "octavo build h.ply -r 4K --json --journal-seconds 0.1" + options;
    ASSERT_EQ(run_shell(folder.path(), "octavo sample hairball -o h.ply --size 0.3").code, 0);
    const auto begin = std::chrono::steady_clock::now();
    const Outcome whole = run_shell(folder.path(), build + " -o whole.octv");
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    ASSERT_EQ(whole.code, 0) << whole.err;
    ASSERT_EQ(first_done(whole.err), 1u);

    const unsigned seed = std::random_device()();
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    // Together less than a whole build, so that none of them gets to the end; but the machine may
    // have become faster since it was timed, and then they must be killed sooner.
    const auto is_done = [&] { return std::filesystem::exists(folder / "killed.octv"); };
    for (double longest = 0.45; longest > 0.05; longest /= 2) {
        std::uniform_real_distribution<double> part(longest / 1.5, longest);
        for (int kill = 0; kill < 2 && !is_done(); ++kill)
            run_shell(folder.path(), "timeout -s KILL " +
                                         std::to_string(part(random) * seconds.count()) + " " +
                                         build + " -o killed.octv -q");
        if (!is_done()) break;
        EXPECT_EQ(run_shell(folder.path(), "cmp whole.octv killed.octv").code, 0);
        std::filesystem::remove(folder / "killed.octv");
        std::filesystem::remove_all(folder / "killed.octv.scratch");
    }
    const Outcome rest = run_shell(folder.path(), build + " -o killed.octv");
    ASSERT_EQ(rest.code, 0) << rest.err;
    EXPECT_NE(first_done(rest.err), 1u) << "it began again from nothing";
    EXPECT_EQ(run_shell(folder.path(), "cmp whole.octv killed.octv").code, 0);
    EXPECT_EQ(folder.entries(), 3u) << "the scratch is still there";
}

TEST(InterruptSlow, AKilledBuildGoesOnAndEndsInTheSameBytes) {
    kill_and_go_on("");
}

TEST(InterruptSlow, AKilledBuildThatSpillsGoesOnAndEndsInTheSameBytes) {
    kill_and_go_on(" --max-memory 128M");
}

}  // namespace
}  // namespace octavo::test
