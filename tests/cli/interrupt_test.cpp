// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "cli/run_command.h"

namespace octavo::test {
namespace {

/// Sends a signal to a build that would take minutes, once it is on its way.
Outcome interrupt(const TemporaryFolder& folder, const std::string& signal) {
    return run_shell(folder.path(),
                     "octavo build sample:hairball -o a.octv -r 16K 2>err & pid=$!\n"
                     "for i in $(seq 600); do grep -q voxelize err && break; sleep 0.1; done\n"
                     "kill -" +
                         signal + " $pid; wait $pid; code=$?; cat err >&2; rm err; exit $code");
}

TEST(InterruptSlow, EndsABuildInGoodOrder) {
    for (const auto& [signal, code] : {std::pair("INT", 130), std::pair("TERM", 143)}) {
        const TemporaryFolder folder;
        const Outcome outcome = interrupt(folder, signal);
        EXPECT_EQ(outcome.code, code) << outcome.err;
        EXPECT_NE(outcome.err.find("octavo: "), std::string::npos) << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.octv"));
        // At most the scratch from which the same command goes on.
        EXPECT_LE(folder.entries(), std::filesystem::exists(folder.path() / "a.octv.scratch"));
    }
}

/// Kills a build again and again, each time a little later, until one run gets to the end.
void kill_until_done(const std::string& options) {
    const TemporaryFolder folder;
    const Outcome outcome =
        run_shell(folder.path(),
                  "octavo sample hairball -o h.ply --size 0.2\n"
                  "octavo build h.ply -o whole.octv -r 2K -q || exit 1\n"
                  "for tenths in $(seq 2 2 200); do\n"
                  "  octavo build h.ply -o killed.octv -r 2K -q --journal-seconds 0.1" +
                      options +
                      " & pid=$!\n"
                      "  sleep $((tenths / 10)).$((tenths % 10))\n"
                      "  kill -KILL $pid 2>/dev/null || { wait $pid; break; }\n"
                      "  wait $pid; test ! -e killed.octv || break\n"
                      "done 2>/dev/null\n"
                      "cmp whole.octv killed.octv && ls");
    EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
    EXPECT_EQ(outcome.out, "h.ply\nkilled.octv\nwhole.octv\n");
}

TEST(InterruptSlow, AKilledBuildGoesOnAndEndsInTheSameBytes) {
    kill_until_done("");
}

TEST(InterruptSlow, AKilledBuildThatSpillsGoesOnAndEndsInTheSameBytes) {
    kill_until_done(" --max-memory 100M");
}

}  // namespace
}  // namespace octavo::test
