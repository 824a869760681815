// SPDX-License-Identifier: MIT
// Numbers on the command line that make no sense.
#include <gtest/gtest.h>

#include "cli/run_command.h"

namespace octavo::test {
namespace {

TEST(Numbers, ThatAreNoneOrOutOfRangeAreUsageInFewWords) {
    const TemporaryFolder folder;
    const std::string octv = small_octv().string();
    const std::string build = "build sample:courtyard -o a.octv -r 16 -q ";
    const std::string render = "render " + octv + " -o a.png --size 8x8 -q ";
    for (const char* number : {"nan", "-nan", "inf", "1e999", "-1", "x", "", "1,2", "0x"})
        for (const std::string& option :
             {build + "--origin 0,0,0 --voxel-size", build + "--journal-seconds",
              render + "--ao-radius", render + "--ao-cone", render + "--bias", render + "--fov",
              render + "--light point:0,5,0:power", render + "--sky clear:power",
              std::string("sample courtyard -o a.ply --size")}) {
            const bool part = option.ends_with("power");
            const std::string line = option + (part ? "=" : " ") + "'" + number + "'";
            const Outcome outcome = run_shell(folder.path(), "octavo " + line);
            EXPECT_EQ(outcome.code, 2) << line;
            EXPECT_EQ(lines_in(outcome.err), 1) << outcome.err;
            EXPECT_LT(outcome.err.size(), 160u) << outcome.err;
        }
    for (const char* exposure : {"nan", "33", "-inf"})
        EXPECT_EQ(run_shell(folder.path(), "octavo " + render + "--exposure " + exposure).code, 2);
    for (const char* color : {"1e39,0,0", "nan,0,0", "-1,0,0"})
        EXPECT_EQ(run_shell(folder.path(), "octavo " + render + "--sky color:" + color).code, 2);
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Numbers, OfAGridAreCheckedBeforeTheSceneIsRead) {
    const TemporaryFolder folder;
    for (const char* grid :
         {"--origin 0,0,0 --voxel-size 1e308", "--origin 1e308,0,0 --voxel-size 1"}) {
        const Outcome outcome = run_shell(
            folder.path(), std::string("octavo build missing.glb -o a.octv -r 16 ") + grid);
        EXPECT_EQ(outcome.code, 2) << grid << outcome.err;
    }
}

TEST(Numbers, ThatAreTakenMeanWhatTheySay) {
    const TemporaryFolder folder;
    const std::string octv = small_octv().string();
    const std::string render = "octavo render " + octv + " --size 24x16 --ao 1 --samples 1 -q ";
    ASSERT_EQ(run_shell(folder.path(), render + "-o a.png --exposure -1.5").code, 0);
    ASSERT_EQ(run_shell(folder.path(), render + "-o b.png --exposure 1.5").code, 0);
    EXPECT_NE(file_content(folder / "a.png"), file_content(folder / "b.png"));
}

TEST(Numbers, NamesThatAreNoneAreNamed) {
    const TemporaryFolder folder;
    for (const auto& [line, said] : {std::pair("octavo foo", "'foo'"),
                                     {"octavo sample nope", "'nope'"},
                                     {"octavo sample nope -o a.ply", "'nope'"},
                                     {"octavo sample '' -o a.ply", "''"},
                                     {"octavo sample courtyard -o a.xyz", "a.xyz"},
                                     {"octavo info ''", "empty"},
                                     {"octavo build sample:courtyard -r 16 -o ''", "empty"}}) {
        const Outcome outcome = run_shell(folder.path(), line);
        EXPECT_EQ(outcome.code, 2) << line;
        EXPECT_NE(outcome.err.find(said), std::string::npos) << line << ": " << outcome.err;
    }
    EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace octavo::test
