// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "cli/run_command.h"

namespace octavo::test {
namespace {

TEST(Streams, ClosedOutputIsAnError) {
    const std::string octv = small_octv().string();
    for (const std::string& line :
         {"octavo info " + octv + " >&-", std::string("octavo --version >&-"),
          "octavo info " + octv + " >/dev/full", std::string("octavo --help >/dev/full"),
          "octavo query " + octv + " --point 0,0,0 >/dev/full"}) {
        const Outcome outcome = run_shell(".", line);
        EXPECT_EQ(outcome.code, 1) << line;
        EXPECT_NE(outcome.err.find("standard output"), std::string::npos) << outcome.err;
    }
}

TEST(Streams, FileNeverTakesTheNumberOfAClosedStream) {
    const TemporaryFolder folder;
    const Outcome outcome = run_shell(
        folder.path(), "octavo build sample:courtyard -o a.octv -r 64 --json <&- >&- 2>&-");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(file_content(folder / "a.octv"), file_content(small_octv()));
}

TEST(Streams, ProgressGoesToStandardErrorAndNotWhenQuiet) {
    const TemporaryFolder folder;
    const std::string build = "octavo build sample:courtyard -r 64 ";
    const Outcome loud = run_shell(folder.path(), build + "-o a.octv --json");
    EXPECT_NE(loud.err.find("voxelize"), std::string::npos) << loud.err;
    EXPECT_EQ(loud.err.find('\r'), std::string::npos) << "a bar, though this is no terminal";
    EXPECT_EQ(loud.out.front(), '{');
    const Outcome quiet = run_shell(folder.path(), build + "-o b.octv --quiet");
    EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST(Streams, FullDiskLeavesTheOldFile) {
    const TemporaryFolder folder;
    write_file(folder / "a.octv", "old");
    // ulimit counts in blocks of 1024 bytes; the file would take more than 8192.
    const Outcome outcome = run_shell(
        folder.path(),
        "trap '' XFSZ; ulimit -f 5; octavo build sample:courtyard -o a.octv -r 64 -q --force");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("a.octv"), std::string::npos) << outcome.err;
    EXPECT_EQ(file_content(folder / "a.octv"), "old");
    EXPECT_EQ(folder.entries(), 1u);
}

}  // namespace
}  // namespace octavo::test
