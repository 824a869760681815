// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_command.h"

namespace octavo::test {
namespace {

using Json = nlohmann::json;

/// A green triangle that glows, in 16^3 voxels of half a unit.
class AttributeCommands : public testing::Test {
protected:
    AttributeCommands() {
        write_file(folder / "t.mtl", "newmtl leaf\nKd 0 1 0\nKe 2 0 0\n");
        write_file(folder / "t.obj",
                   "mtllib t.mtl\nusemtl leaf\nv 1 1 1.1\nv 5 1 1.1\nv 1 5 1.1\nf 1 2 3\n");
    }
    Outcome build(const std::string& options) {
        return run_shell(
            folder.path(),
            "octavo build t.obj -f -o t.octv -r 16 --origin 0,0,0 --voxel-size 0.5 " + options);
    }
    TemporaryFolder folder;
};

TEST_F(AttributeCommands, QueryTellsTheColour) {
    ASSERT_EQ(build("-q --attributes color,emission,normal").code, 0);
    const std::string ask = "octavo query t.octv --point 1.75,1.75,1.1";
    EXPECT_EQ(run_shell(folder.path(), ask).out,
              "voxel 3,3,2 is set, color #00ff00, emission 2,0,0, surface normal 0,0,1\n");
    const Json json = Json::parse(run_shell(folder.path(), ask + " --json").out);
    EXPECT_EQ(json.at("color"), Json({0, 255, 0}));
    const Json ray = Json::parse(
        run_shell(folder.path(), "octavo query t.octv --ray 1.75,1.75,9,0,0,-1 --json").out);
    EXPECT_EQ(ray.at("color"), Json({0, 255, 0}));
}

TEST_F(AttributeCommands, ResolutionMayBeLower) {
    ASSERT_EQ(build("-q --attributes color --attribute-resolution 4").code, 0);
    const Json json = Json::parse(run_shell(folder.path(), "octavo info t.octv --json").out);
    EXPECT_EQ(json.at("attributes").at("resolution"), 4);
    EXPECT_EQ(run_shell(folder.path(), "octavo query t.octv --point 1.75,1.75,1.1").out,
              "voxel 3,3,2 is set, color #00ff00\n");
    EXPECT_NE(build("-q --attributes color --attribute-resolution 32").code, 0);
}

TEST_F(AttributeCommands, InfoHasTheTableOfThePost) {
    ASSERT_EQ(build("-q --attributes color,emission --attribute-quality 90").code, 0);
    const std::string info = run_shell(folder.path(), "octavo info t.octv").out;
    for (const char* row : {"color ", "emission ", "all attributes", "octree, 48 bytes/node",
                            "volume, DXT5 and DXT1", "volume, 7 bytes", "within 5 of 255"})
        EXPECT_NE(info.find(row), std::string::npos) << row;
}

TEST_F(AttributeCommands, WrongNamesAndOptionsAloneAreRefused) {
    EXPECT_EQ(build("-q --attributes color,taste").code, 2);
    EXPECT_EQ(build("-q --attribute-quality 50").code, 2);
    EXPECT_EQ(build("-q --attribute-resolution 8").code, 2);
}

TEST_F(AttributeCommands, RenderUsesColourUnlessToldNotTo) {
    ASSERT_EQ(build("-q --attributes color").code, 0);
    const std::string render =
        "octavo render t.octv -q -f --size 32x32 --samples 1 --ao 0 --shadows none -o ";
    ASSERT_EQ(run_shell(folder.path(), render + "color.png").code, 0);
    ASSERT_EQ(run_shell(folder.path(), render + "clay.png --no-color").code, 0);
    EXPECT_NE(file_content(folder / "color.png"), file_content(folder / "clay.png"));
    ASSERT_EQ(build("-q").code, 0);
    ASSERT_EQ(run_shell(folder.path(), render + "none.png").code, 0);
    EXPECT_EQ(file_content(folder / "none.png"), file_content(folder / "clay.png"));
}

}  // namespace
}  // namespace octavo::test
