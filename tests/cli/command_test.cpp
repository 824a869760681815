// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "cli/run_command.h"

namespace octavo::test {
namespace {

const std::string kCommands[] = {"build", "info", "render", "query", "sample"};

TEST(Command, TellsItsVersion) {
    const Outcome outcome = run_shell(".", "octavo --version");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.out.substr(0, 7), "octavo ");
    EXPECT_EQ(lines_in(outcome.out), 1);
}

TEST(Command, HelpStartsWithExamples) {
    EXPECT_TRUE(run_shell(".", "octavo --help").out.starts_with("Examples:\n  octavo "));
    for (const std::string& command : kCommands) {
        const Outcome outcome = run_shell(".", "octavo " + command + " --help");
        EXPECT_EQ(outcome.code, 0);
        EXPECT_TRUE(outcome.out.starts_with("Examples:\n  octavo " + command)) << outcome.out;
        EXPECT_NE(outcome.out.find("Usage: octavo " + command), std::string::npos) << outcome.out;
    }
}

TEST(Command, WrongUsageIsOneLineAndCode2) {
    const TemporaryFolder folder;
    const std::string octv = small_octv().string();
    for (const std::string& arguments :
         {std::string(""),
          std::string("bild"),
          std::string("build"),
          std::string("build sample:courtyard -o a.octv"),
          std::string("build sample:courtyard -o a.octv -r 1000"),
          std::string("build sample:courtyard -o a.octv -r 256K"),
          std::string("build sample:courtyard -o a.octv -r 99999999999999999999"),
          std::string("build sample:courtyard -o a.octv -r 64 --rule thick"),
          std::string("build sample:courtyard -o a.octv -r 64 --origin 0,0,0"),
          std::string("build sample:courtyard -o a.octv -r 64 --origin 0,0 --voxel-size 1"),
          std::string("build sample:courtyard -o a.octv -r 64 --origin 0,0,0 --voxel-size -1"),
          std::string("build sample:courtyard -o a.octv -r 64 --max-memory lots"),
          std::string("build sample:castle -o a.octv -r 64"),
          "info " + octv + " --what",
          "query " + octv,
          "query " + octv + " --point 1,2,x",
          "query " + octv + " --ray 0,0,0,0,0,0",
          "query " + octv + " --point 0,0,0 --ray 0,0,0,1,0,0",
          "render " + octv + " -o a.gif",
          "render " + octv + " -o a.png --size 0x10",
          "render " + octv + " -o a.png --camera Nobody",
          std::string("sample courtyard"),
          std::string("sample castle -o a.glb")}) {
        const Outcome outcome = run_shell(folder.path(), "octavo " + arguments);
        EXPECT_EQ(outcome.code, 2) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_TRUE(outcome.err.find("octavo: ") != std::string::npos) << outcome.err;
        EXPECT_EQ(folder.entries(), 0u) << arguments;
    }
}

TEST(Command, WhatIsMisspeltIsNamedThoughItMakesSomethingElseMissing) {
    const TemporaryFolder folder;
    const auto error = [&](const std::string& arguments) {
        const Outcome outcome = run_shell(folder.path(), "octavo " + arguments);
        EXPECT_EQ(outcome.code, 2) << arguments;
        EXPECT_EQ(folder.entries(), 0u) << arguments;
        return outcome.err;
    };
    EXPECT_EQ(error("build a.glb -o a.octv --resolutoin 64"),
              "octavo: there is no option '--resolutoin'; see octavo build --help\n");
    EXPECT_EQ(error("build -dash.glb -o a.octv -r 64"),
              "octavo: there is no option '-dash.glb'; see octavo build --help\n");
    EXPECT_EQ(error("info a.octv --levels --what"),
              "octavo: there is no option '--what'; see octavo info --help\n");
    EXPECT_EQ(error("info a.octv b.octv"),
              "octavo: 'b.octv' is one argument too many; see octavo info --help\n");
    EXPECT_EQ(error("help build"), "octavo: there is no command 'help'; see octavo build --help\n");
    EXPECT_EQ(error("bild"), "octavo: there is no command 'bild'; see octavo --help\n");
    EXPECT_EQ(error("-V"), "octavo: there is no option '-V'; see octavo --help\n");
    EXPECT_EQ(error("bench bild"), "octavo: there is no command 'bild'; see octavo bench --help\n");
    EXPECT_EQ(error("build a.glb -o a.octv"),
              "octavo: --resolution is required; see octavo build --help\n");
}

TEST(Command, ADashIsNoFileToWrite) {
    const TemporaryFolder folder;
    const std::string octv = small_octv().string();
    for (const std::string& arguments :
         {std::string("build sample:courtyard -r 64 -o -"), "export " + octv + " --html -",
          std::string("sample courtyard -o -"), "render " + octv + " --size 8x8 -o -"}) {
        const Outcome outcome = run_shell(folder.path(), "octavo " + arguments);
        EXPECT_EQ(outcome.code, 2) << arguments << "\n" << outcome.err;
        EXPECT_EQ(folder.entries(), 0u) << arguments;
    }
    EXPECT_EQ(run_shell(folder.path(), "octavo build sample:courtyard -r 64 -q -o ./-").code, 0);
}

TEST(Command, ExitCodesTellWhatFailed) {
    const TemporaryFolder folder;
    write_file(folder / "text.octv", "this is a letter to you");
    EXPECT_EQ(run_shell(folder.path(), "octavo info missing.octv").code, 1);
    EXPECT_EQ(run_shell(folder.path(), "octavo build missing.glb -o a.octv -r 64").code, 1);
    EXPECT_EQ(run_shell(folder.path(), "octavo build sample:courtyard -o no/a.octv -r 64").code, 1);
    const Outcome outcome = run_shell(folder.path(), "octavo info text.octv");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.err, "octavo: text.octv at byte 0: this is not an .octv file\n");
    EXPECT_EQ(run_shell(folder.path(), "octavo render text.octv -o a.png").code, 3);
    EXPECT_EQ(run_shell(folder.path(), "octavo query text.octv --point 0,0,0").code, 3);
    write_file(folder / "broken.ply", "ply\nformat ascii 1.0\nelement vertex 1e9\n");
    EXPECT_EQ(run_shell(folder.path(), "octavo build broken.ply -o a.octv -r 64").code, 3);
    EXPECT_EQ(
        run_shell(folder.path(), "octavo build sample:courtyard -o a.octv -r 64 --max-memory 1K")
            .code,
        4);
}

TEST(Command, ReplacesAFileOnlyWhenForced) {
    const TemporaryFolder folder;
    std::filesystem::copy(small_octv(), folder / "in.octv");
    for (const std::string line :
         {"octavo build sample:courtyard -o out.octv -r 16",
          "octavo render in.octv -o out.png --size 16x16 --ao 1 --samples 1",
          "octavo sample courtyard -o out.ply --size 0.01"}) {
        const std::string file =
            line.substr(line.find("out."), line.find(' ', line.find("out.")) - line.find("out."));
        write_file(folder / file, "precious");
        const Outcome refused = run_shell(folder.path(), line);
        EXPECT_EQ(refused.code, 1) << line;
        EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
        EXPECT_EQ(file_content(folder / file), "precious");
        const Outcome forced = run_shell(folder.path(), line + " --force");
        EXPECT_EQ(forced.code, 0) << forced.err;
        EXPECT_NE(file_content(folder / file), "precious");
    }
}

TEST(Command, ListsTheSamples) {
    const Outcome outcome = run_shell(".", "octavo sample");
    EXPECT_EQ(outcome.code, 0);
    for (const std::string name : {"courtyard", "hairball", "scan", "city"})
        EXPECT_NE(outcome.out.find(name), std::string::npos) << name;
}

}  // namespace
}  // namespace octavo::test
