// SPDX-License-Identifier: MIT
// The command with files that are odd in other ways than their bytes.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/run_command.h"
#include "harness.h"
#include "support/sanitized.h"
#include "support/shared_scenes.h"

namespace octavo::test {
namespace {

namespace fs = std::filesystem;

std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

class Names : public testing::TestWithParam<std::string> {};

TEST_P(Names, AreTakenAsTheyAre) {
    const TemporaryFolder folder;
    const std::string name = GetParam();
    const std::string octv = quoted(name + ".octv");
    fs::create_directory(folder / name);
    for (const std::string& line :
         {"octavo sample courtyard --size 0.05 -o " + quoted(name + ".obj"),
          "octavo build " + quoted(name + ".obj") + " -r 32 -q -o " + octv,
          "octavo validate --strict --json " + octv, "octavo info --json " + octv,
          "octavo query --json --point 0,0,0 " + octv,
          "octavo render -q --size 16x16 -o " + quoted(name + "/a.png") + " " + octv}) {
        const Outcome outcome = run_shell(folder.path(), line);
        EXPECT_EQ(outcome.code, 0) << line << "\n" << outcome.err;
        if (line.find("--json") != std::string::npos) {
            EXPECT_TRUE(nlohmann::json::accept(outcome.out)) << outcome.out;
        }
    }
    const Outcome missing = run_shell(folder.path(), "octavo info " + quoted(name + " is missing"));
    EXPECT_EQ(missing.code, 1);
    EXPECT_EQ(lines_in(missing.err), 1) << missing.err;
}

INSTANTIATE_TEST_SUITE_P(Odd, Names,
                         testing::Values("a b", "a\nb",
                                         "Gr\xc3\xbc\xc3\x9f"
                                         "e \xe2\x82\xac",
                                         "not\xff utf-8", "quote\"'", "semi;colon", "100%",
                                         "tab\tname"),
                         [](const auto& test) { return "Name" + std::to_string(test.index); });

TEST(Validate, ExitCodeIsThreeWhereThereAreFindings) {
    const TemporaryFolder folder;
    std::string bytes = file_content(small_octv());
    write_file(folder / "good.octv", bytes);
    bytes.back() ^= 1;
    write_file(folder / "bad.octv", bytes);
    EXPECT_EQ(run_shell(folder.path(), "octavo validate good.octv --strict").code, 0);
    const Outcome bad = run_shell(folder.path(), "octavo validate bad.octv --json");
    EXPECT_EQ(bad.code, 3);
    EXPECT_EQ(lines_in(bad.err), 1) << bad.err;
    const auto json = nlohmann::json::parse(bad.out);
    EXPECT_EQ(json["valid"], false);
    EXPECT_EQ(json["findings"][0]["code"], "section-checksum");
    EXPECT_TRUE(json["seconds"]["validate"].is_number());
    EXPECT_LT(json["validate_share_of_reading"], 1.0);
    const Outcome text = run_shell(folder.path(), "octavo validate bad.octv");
    EXPECT_NE(text.out.find("section-checksum"), std::string::npos) << text.out;
    EXPECT_EQ(run_shell(folder.path(), "octavo validate missing.octv").code, 1);
    EXPECT_EQ(run_shell(folder.path(), "octavo validate good.octv >/dev/full").code, 1);
    EXPECT_EQ(run_shell(folder.path(), "octavo validate good.octv >&-").code, 1);
}

TEST(Hardening, ReleaseProgramMovesItsAddressesAndBindsThemAtOnce) {
    const std::string command = quoted(OCTAVO_COMMAND);
    const Outcome dynamic = run_shell(".", "readelf -hd " + command);
    if (dynamic.code != 0) GTEST_SKIP() << "no readelf here";
    if (!OCTAVO_IS_RELEASE) GTEST_SKIP() << "this is no release build";
    EXPECT_NE(dynamic.out.find("DYN (Position-Independent"), std::string::npos) << dynamic.out;
    EXPECT_NE(dynamic.out.find("BIND_NOW"), std::string::npos) << dynamic.out;
    EXPECT_NE(run_shell(".", "readelf -lW " + command + " | grep GNU_RELRO").out, "");
}

TEST(Trusted, OpensTheFileUncheckedAndOtherwiseTheSame) {
    const TemporaryFolder folder;
    const std::string octv = quoted(small_octv().string());
    const std::string ray = " --ray 0,100,0,0.01,-1,0.02 --json";
    EXPECT_EQ(run_shell(".", "octavo query --trusted " + octv + ray).out,
              run_shell(".", "octavo query " + octv + ray).out);
    const std::string render = "octavo render -q --size 32x32 " + octv;
    run_shell(folder.path(), render + " -o a.png && " + render + " --trusted -o b.png");
    EXPECT_EQ(file_content(folder / "a.png"), file_content(folder / "b.png"));
    EXPECT_FALSE(file_content(folder / "a.png").empty());
}

TEST(TwoBuilds, OfOneOutputLeaveOneWholeFile) {
    const TemporaryFolder folder;
    const std::string build =
        "octavo build sample:courtyard -o a.octv -r 64 -q --force --journal-seconds 0";
    for (int round = 0; round < 3; ++round) {
        const Outcome outcome =
            run_shell(folder.path(), build + " & first=$!; " + build +
                                         "; second=$?; wait $first; echo $? $second");
        // One may find the other's journal locked.
        const bool fine =
            outcome.out == "0 0\n" || outcome.out == "0 1\n" || outcome.out == "1 0\n";
        EXPECT_TRUE(fine) << outcome.out << outcome.err;
        EXPECT_EQ(file_content(folder / "a.octv"), file_content(small_octv()));
    }
    EXPECT_EQ(folder.entries(), 1u) << "something was left behind";
}

TEST(SmallDisk, FullWhileWritingLeavesTheOldFile) {
    const TemporaryFolder folder;
    const fs::path disk = folder / "disk";
    fs::create_directory(disk);
    if (run_shell(".", "mount -t tmpfs -o size=16k none " + quoted(disk.string())).code != 0)
        GTEST_SKIP()
            << "no small disk can be mounted here; disk_faults and cli.Streams cover ENOSPC "
               "and the size limit";
    write_file(disk / "a.octv", "old");
    const Outcome outcome =
        run_shell(disk, "octavo build sample:courtyard -o a.octv -r 128 -q --force");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("No space left"), std::string::npos) << outcome.err;
    EXPECT_EQ(file_content(disk / "a.octv"), "old");
    EXPECT_EQ(std::distance(fs::directory_iterator(disk), fs::directory_iterator()), 1);
    run_shell(".", "umount " + quoted(disk.string()));
}

/// "CODE TRIANGLES NAME" of each odd mesh whose reader is ours, as frozen in odd_meshes.txt.
std::map<std::string, std::string> frozen_outcomes() {
    std::istringstream lines(
        file_content(fs::path(OCTAVO_SOURCE_DIR) / "tests" / "trust" / "odd_meshes.txt"));
    std::map<std::string, std::string> outcomes;
    std::string code, triangles, name;
    while (lines >> code >> triangles && std::getline(lines >> std::ws, name))
        outcomes[name] = code + " " + triangles;
    return outcomes;
}

/// Every odd mesh through the command: a DAG, or one line and exit code 3 or 4. Which of them, and
/// how many triangles, is frozen: a file that is taken or refused by mistake is seen here.
TEST(OddMeshesSlow, EndInADagOrOneLine) {
    OCTAVO_REQUIRE_SCENE("odd-meshes");
    const TemporaryFolder folder;
    const fs::path scenes = shared_scenes() / "odd-meshes";
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(scenes))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::ranges::sort(files);

    const auto frozen = frozen_outcomes();
    std::map<std::string, int> outcomes;
    std::size_t compared = 0;
    const std::string limit = kSanitized ? "" : "ulimit -v 4000000; ";
    for (const fs::path& file : files) {
        const Outcome outcome =
            run_shell(folder.path(),
                      limit + "timeout 60 octavo build " + quoted(fs::absolute(file).string()) +
                          " -o a.octv -r 64 -q --force && octavo validate --strict a.octv "
                          ">valid && octavo info --json a.octv");
        const std::string name = fs::relative(file, scenes).string();
        std::string triangles = "-", what = outcome.err;
        if (outcome.code == 0)
            triangles = nlohmann::json::parse(outcome.out).at("triangles").dump();
        if (!what.empty() && what.back() == '\n') what.pop_back();
        const std::size_t reason = what.find(name);
        if (reason != std::string::npos) what.erase(0, reason + name.size());
        const std::string found = std::to_string(outcome.code) + " " + triangles;
        std::cout << found << " " << name << what << "\n";
        if (const auto expected = frozen.find(name); expected != frozen.end()) {
            EXPECT_EQ(found, expected->second) << name << ": " << outcome.err;
            ++compared;
        }
        EXPECT_TRUE(outcome.code == 0 || outcome.code == 3 || outcome.code == 4)
            << name << ": " << outcome.code << " " << outcome.err;
        if (outcome.code != 0) {
            EXPECT_EQ(lines_in(outcome.err), 1) << name << ": " << outcome.err;
        }
        ++outcomes["exit " + std::to_string(outcome.code)];
    }
    for (const auto& [outcome, count] : outcomes) std::cout << outcome << ": " << count << "\n";
    EXPECT_EQ(compared, frozen.size());
}

}  // namespace
}  // namespace octavo::test
