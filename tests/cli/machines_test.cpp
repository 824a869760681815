// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "cli/run_command.h"

namespace octavo::test {
namespace {

// Without the affinity that mpirun gives two ranks or fewer, and with more ranks than cores.
constexpr const char* kMpirun = "mpirun --allow-run-as-root --oversubscribe --bind-to none ";

class Machines : public testing::Test {
protected:
    void SetUp() override {
#ifndef OCTAVO_HAS_MPI
        GTEST_SKIP() << "compiled without MPI (libopenmpi-dev)";
#endif
        if (run_shell("/", "command -v mpirun").code != 0)
            GTEST_SKIP() << "there is no mpirun (openmpi-bin)";
    }
};
using MachinesSlow = Machines;

TEST_F(MachinesSlow, AnyNumberOfRanksGivesTheFileOfOneProcess) {
    const TemporaryFolder folder;
    const std::string build = "octavo build sample:courtyard -r 1K --tile 64 -q ";
    ASSERT_EQ(run_shell(folder.path(), build + "-o one.octv").code, 0);
    for (const std::string ranks : {"1", "2", "3", "4"}) {
        for (const std::string options : {"", " --max-memory 80M"}) {
            const Outcome outcome = run_shell(
                folder.path(), kMpirun + ("-n " + ranks) + " " + build + "-f -o many.octv" +
                                   options + " && cmp one.octv many.octv");
            EXPECT_EQ(outcome.code, 0) << ranks << options << outcome.out << outcome.err;
        }
    }
    EXPECT_EQ(folder.entries(), 2u) << "the scratch is still there";
}

TEST_F(MachinesSlow, OnlyOneRankSpeaks) {
    const TemporaryFolder folder;
    const Outcome outcome =
        run_shell(folder.path(), std::string(kMpirun) +
                                     "-n 3 octavo build sample:courtyard -r 256 -o a.octv --json");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    std::size_t summaries = 0;
    for (std::size_t at = 0; (at = outcome.out.find("\"dag_nodes\"", at)) != std::string::npos;
         ++at)
        ++summaries;
    EXPECT_EQ(summaries, 1u + 8u) << "one for the whole and one for each level";
    EXPECT_NE(outcome.out.find("\"ranks\": 3"), std::string::npos) << outcome.out;
}

TEST_F(MachinesSlow, AnErrorOfOneRankEndsAllWithItsExitCode) {
    const TemporaryFolder folder;
    const Outcome outcome = run_shell(
        folder.path(), std::string(kMpirun) + "-n 2 octavo build missing.obj -r 256 -o a.octv");
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("missing.obj"), std::string::npos) << outcome.err;
}

TEST_F(MachinesSlow, AJobWhoseRankIsKilledEndsWithAnErrorAndTheNextOneGoesOn) {
    const TemporaryFolder folder;
    const std::string build = "octavo build h.ply -r 2K --tile 64 -q --threads 1 ";
    const std::string mpirun = kMpirun;
    const Outcome killed = run_shell(
        folder.path(),
        "octavo sample hairball -o h.ply --size 0.2\n" + build + "-o one.octv || exit 9\n" +
            mpirun + "-n 3 " + build +
            "-o many.octv & job=$!\n"
            "for i in $(seq 600); do ls many.octv.scratch/part-* && break; sleep 0.02; done\n"
            "kill -KILL $(pgrep -P $job octavo | tail -1); wait $job");
    ASSERT_NE(killed.code, 9);
    EXPECT_NE(killed.code, 0);
    EXPECT_NE(killed.err.find("signal 9"), std::string::npos) << killed.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "many.octv"));
    const Outcome parts = run_shell(folder.path(), "ls many.octv.scratch | grep -c part-");
    EXPECT_GT(std::atoi(parts.out.c_str()), 0);

    // With another number of ranks, and with none.
    const Outcome went_on =
        run_shell(folder.path(), "cp -r many.octv.scratch alone.octv.scratch\n" + mpirun + "-n 2 " +
                                     build + "-o many.octv && cmp one.octv many.octv && " + build +
                                     "-o alone.octv && cmp one.octv alone.octv && ls");
    EXPECT_EQ(went_on.code, 0) << went_on.err;
    EXPECT_EQ(went_on.out, "alone.octv\nh.ply\nmany.octv\none.octv\n");
}

}  // namespace
}  // namespace octavo::test
