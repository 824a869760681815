// SPDX-License-Identifier: MIT
// Where results may go: what cannot be written is said before the work, and nothing is lost.
#include <gtest/gtest.h>

#include "cli/run_command.h"

namespace octavo::test {
namespace {

class Output : public testing::Test {
protected:
    Output() {
        const Outcome made =
            run("octavo sample courtyard --size 0.01 -o s.ply; octavo build s.ply "
                "-r 16 -q -o s.octv --attributes color");
        EXPECT_EQ(made.code, 0) << made.err;
    }
    [[nodiscard]] Outcome run(const std::string& line) const {
        return run_shell(folder.path(), line);
    }
    TemporaryFolder folder;
};

TEST_F(Output, ThatIsAnInputIsRefusedEvenByForce) {
    ASSERT_EQ(
        run("ln s.octv same.html; ln -s s.octv link.octv; cp s.octv a.octv; cp s.ply b.ply").code,
        0);
    const std::string octv = file_content(folder / "s.octv"), ply = file_content(folder / "s.ply");
    for (const char* line :
         {"octavo build s.ply -o s.ply -r 16 -f", "octavo build ./s.ply -o s.ply -r 16 -f",
          "octavo export s.octv --html same.html -f",
          "octavo export link.octv --html s.octv "
          "--single-file -f"}) {
        const Outcome outcome = run(line);
        if (outcome.err.find("no viewer") != std::string::npos) continue;
        EXPECT_EQ(outcome.code, 2) << line << outcome.err;
        EXPECT_NE(outcome.err.find("would be lost"), std::string::npos) << outcome.err;
    }
    EXPECT_TRUE(file_content(folder / "s.octv") == octv);
    EXPECT_TRUE(file_content(folder / "s.ply") == ply);
    // Light goes into the file that it lights.
    EXPECT_EQ(run("octavo light s.octv -o s.octv -f -q --rays 1").code, 0);
}

TEST_F(Output, ThatIsNoRegularFileIsRefusedBeforeTheWork) {
    ASSERT_EQ(run("mkdir d.octv d.png d.ply; mkfifo p.octv; ln -s /dev/full f.png").code, 0);
    for (const char* line :
         {// Were the inputs read first, these would end in another code.
          "octavo build missing.ply -o d.octv -r 16 -f",
          "octavo build missing.ply -o p.octv -r 16 -f", "octavo light missing.octv -o d.octv -f",
          "octavo render missing.octv -o d.png -f", "octavo render missing.octv -o f.png -f",
          "octavo sample courtyard -o d.ply -f"}) {
        const Outcome outcome = run(line);
        EXPECT_EQ(outcome.code, 1) << line << outcome.err;
        EXPECT_NE(outcome.err.find("cannot write: it is not a regular file"), std::string::npos)
            << line << ": " << outcome.err;
    }
}

TEST_F(Output, ALinkThatLeadsToNothingIsReplacedByForceAlone) {
    ASSERT_EQ(run("ln -s target.octv link.octv").code, 0);
    EXPECT_EQ(run("octavo build s.ply -o link.octv -r 16 -q").code, 1);
    EXPECT_FALSE(std::filesystem::exists(folder / "target.octv"));
    EXPECT_EQ(run("octavo build s.ply -o link.octv -r 16 -q -f").code, 0);
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.octv"));
    EXPECT_EQ(run("octavo validate target.octv").code, 0);
}

}  // namespace
}  // namespace octavo::test
