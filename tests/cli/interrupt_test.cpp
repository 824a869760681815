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
        EXPECT_EQ(folder.entries(), 0u);
    }
}

}  // namespace
}  // namespace octavo::test
