// SPDX-License-Identifier: MIT
// Every octavo command in the README runs, in its order; and every script it names is there.
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "cli/run_command.h"

namespace octavo::test {
namespace {

/// Lines of the README's shell blocks that begin with this word, without their comments.
std::vector<std::string> readme_lines(const std::string& first_word) {
    std::istringstream readme(file_content(std::filesystem::path(OCTAVO_SOURCE_DIR) / "README.md"));
    std::vector<std::string> lines;
    bool in_shell = false;
    for (std::string line; std::getline(readme, line);) {
        if (line.starts_with("```")) in_shell = line == "```sh";
        if (in_shell && line.starts_with(first_word))
            lines.push_back(line.substr(0, line.find(" #")));
    }
    return lines;
}

TEST(ReadmeSlow, EveryCommandRuns) {
    const TemporaryFolder folder;
    const std::vector<std::string> lines = readme_lines("octavo ");
    EXPECT_GE(lines.size(), 5u);
    for (const std::string& line : lines) {
        const bool serves = line.starts_with("octavo view");
        const Outcome outcome =
            serves ? serve_and_interrupt(folder.path(), line) : run_shell(folder.path(), line);
        EXPECT_EQ(outcome.code, 0) << line << "\n" << outcome.out << outcome.err;
    }
    EXPECT_TRUE(std::filesystem::exists(folder / "scene.png"));
}

TEST(ReadmeSlow, DemoWritesADagAndAPicture) {
    // The scripts use build/release; beside another build this one would compile everything again.
    const std::filesystem::path source(OCTAVO_SOURCE_DIR);
    if (std::filesystem::path(OCTAVO_COMMAND) != source / "build/release/bin/octavo")
        GTEST_SKIP() << "not the build that scripts/demo uses";
    const TemporaryFolder folder;
    const std::string run =
        "OCTAVO_DEMO_RESOLUTION=64 OCTAVO_DEMO_SIZE=160x90 OCTAVO_DEMO_FOLDER='" +
        folder.path().string() + "' scripts/demo";
    const Outcome first = run_shell(source, run);
    ASSERT_EQ(first.code, 0) << first.err;
    EXPECT_NE(first.out.find("DAG nodes"), std::string::npos) << first.out;
    EXPECT_NE(first.out.find("courtyard-64.png"), std::string::npos) << first.out;
    const auto made = std::filesystem::last_write_time(folder / "courtyard-64.octv");
    ASSERT_EQ(run_shell(source, run).code, 0);
    EXPECT_EQ(std::filesystem::last_write_time(folder / "courtyard-64.octv"), made)
        << "the second run built it again";
}

TEST(Readme, ScriptsAreThere) {
    for (const std::string& line : readme_lines("scripts/")) {
        const std::string script = line.substr(0, line.find(' '));
        EXPECT_EQ(access((std::filesystem::path(OCTAVO_SOURCE_DIR) / script).c_str(), X_OK), 0)
            << script;
    }
    EXPECT_GE(readme_lines("scripts/").size(), 2u);
}

}  // namespace
}  // namespace octavo::test
