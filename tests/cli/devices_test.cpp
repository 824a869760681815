// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "cli/run_command.h"
#include "octavo/light/sky.h"

namespace octavo::test {
namespace {

using Json = nlohmann::json;

Json devices() {
    const TemporaryFolder folder;
    const Outcome outcome = run_shell(folder.path(), "octavo devices --json");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? Json::parse(outcome.out) : Json();
}

/// Why nothing can be drawn through Vulkan here; empty where it can.
std::string vulkan_missing() {
    const Json list = devices();
    std::string why = list.at("missing").value("vulkan", "");
    for (const Json& device : list.at("devices"))
        if (device.at("kind") == "vulkan") why = device.value("why", "");
    return why;
}

TEST(Devices, ListTheProcessorAndEveryKindOrWhyItIsMissing) {
    const Json list = devices();
    EXPECT_EQ(list.at("devices").at(0).at("id"), "cpu");
    EXPECT_EQ(list.at("devices").at(0).at("usable"), true);
    std::set<std::string> kinds;
    for (const Json& device : list.at("devices")) {
        kinds.insert(device.at("kind"));
        EXPECT_GT(device.at("memory_bytes"), 0);
    }
    for (const auto& [kind, why] : list.at("missing").items()) {
        kinds.insert(kind);
        EXPECT_FALSE(why.get<std::string>().empty());
    }
    EXPECT_EQ(kinds, (std::set<std::string>{"cpu", "cuda", "vulkan"}));
}

TEST(BenchPicture, GivesTheTimeOfEachPictureAndOfEachPass) {
    const TemporaryFolder folder;
    const std::string bench = "octavo bench picture " + small_octv().string() +
                              " --frames 2 --size 40x24 --ao 8 --json --device ";
    const Outcome cpu = run_shell(folder.path(), bench + "cpu");
    ASSERT_EQ(cpu.code, 0) << cpu.err;
    EXPECT_EQ(Json::parse(cpu.out).at("seconds").at("frames").size(), 2u);
    EXPECT_EQ(Json::parse(cpu.out).at("rays").at("primary"), 2 * 40 * 24);
    EXPECT_FALSE(Json::parse(cpu.out).contains("passes"));
    if (const std::string why = vulkan_missing(); !why.empty()) GTEST_SKIP() << why;
    const Outcome vulkan = run_shell(folder.path(), bench + "vulkan");
    ASSERT_EQ(vulkan.code, 0) << vulkan.err;
    const Json figures = Json::parse(vulkan.out);
    EXPECT_EQ(figures.at("rays").at("sky"), Json::parse(cpu.out).at("rays").at("sky"));
    for (const char* pass : {"primary", "lamp", "sky"})
        EXPECT_GT(figures.at("passes").at(pass).at("mrays_per_second"), 0.0) << pass;
    EXPECT_GT(figures.at("passes").at("surface").at("seconds"), 0.0);
}

TEST(Devices, ThatAreNoneAreRefused) {
    const TemporaryFolder folder;
    const std::string render = "octavo render " + small_octv().string() + " -o a.png --size 8x8 ";
    for (const char* name : {"gpu", "vulkan:", "vulkan:x", "cpu:1", "''"}) {
        const Outcome outcome = run_shell(folder.path(), render + "--device " + name);
        EXPECT_EQ(outcome.code, 2) << name << outcome.err;
        EXPECT_EQ(lines_in(outcome.err), 1) << outcome.err;
    }
    EXPECT_EQ(run_shell(folder.path(), render + "--device vulkan:99").code, 2);
    EXPECT_EQ(
        run_shell(folder.path(), "octavo build sample:courtyard -o b.octv -r 16 --device vulkan")
            .code,
        2);
}

TEST(Devices, DrawThePictureOfTheProcessorThroughVulkan) {
    if (const std::string why = vulkan_missing(); !why.empty()) GTEST_SKIP() << "vulkan: " << why;
    const TemporaryFolder folder;
    ASSERT_EQ(run_shell(folder.path(),
                        "octavo build sample:courtyard -o color.octv -r 32 --attributes "
                        "color,emission --quiet && octavo light color.octv --rays 2 "
                        "--shadow-samples 1 --bounces 0 --quiet")
                  .code,
              0);
    for (const std::string& what : {small_octv().string(), std::string("color.octv"),
                                    small_octv().string() + " --sky color:1,2,3:power=0.2",
                                    std::string("color.octv --gi cached")}) {
        const std::string render = "octavo render " + what + " --size 64x36 --ao 8 --quiet -f ";
        const Outcome drawn = run_shell(folder.path(), render + "-o gpu.exr --device vulkan");
        ASSERT_EQ(drawn.code, 0) << what << drawn.err;
        ASSERT_EQ(run_shell(folder.path(), render + "-o cpu.exr").code, 0) << what;
        const SkyImage found = load_sky_image(folder / "gpu.exr");
        const SkyImage expected = load_sky_image(folder / "cpu.exr");
        ASSERT_EQ(found.color.size(), expected.color.size());
        std::size_t different = 0;  // where a ray grazes a voxel within rounding
        for (std::size_t i = 0; i < found.color.size(); ++i)
            different += glm::length(found.color[i] - expected.color[i]) > 0.01f;
        EXPECT_LE(different, found.color.size() / 50) << what;
    }
}

TEST(Devices, RefuseWhatOnlyTheProcessorDraws) {
    const TemporaryFolder folder;
    const std::string file = small_octv().string();
    const std::string rest = " --size 8x8 --ao 1 --quiet -o a.png -f --device ";
    for (const std::string& what : {file + " --gi", file + " --reference"}) {
        const Outcome refused = run_shell(folder.path(), "octavo render " + what + rest + "vulkan");
        EXPECT_EQ(refused.code, 2) << what << refused.err;
        EXPECT_NE(refused.err.find("--device"), std::string::npos) << refused.err;
    }
    const Outcome taken =
        run_shell(folder.path(), "octavo render " + file + " --sky none" + rest + "auto");
    EXPECT_EQ(taken.code, 0) << taken.err;
}

TEST(Devices, ReduceTilesOrSayWhyNot) {
    const TemporaryFolder folder;
    const std::string build = "octavo build sample:courtyard -r 64 --quiet ";
    const Outcome outcome = run_shell(folder.path(), build + "-o a.octv --device cuda");
    if (outcome.code != 0) {
        EXPECT_EQ(outcome.code, 2);
        EXPECT_NE(outcome.err.find("CUDA"), std::string::npos) << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(folder / "a.octv"));
        GTEST_SKIP() << outcome.err;
    }
    ASSERT_EQ(run_shell(folder.path(), build + "-o b.octv").code, 0);
    EXPECT_TRUE(file_content(folder / "a.octv") == file_content(folder / "b.octv"));
}

}  // namespace
}  // namespace octavo::test
