// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/run_command.h"

namespace octavo::test {
namespace {

using Json = nlohmann::json;

/// One triangle in the plane z = 1, and a grid of 16^3 voxels of size 0.5 from the origin.
class Query : public testing::Test {
protected:
    Query() {
        write_file(folder / "t.obj", "v 1 1 1\nv 5 1 1\nv 1 5 1\nf 1 2 3\n");
        const Outcome built =
            run_shell(folder.path(),
                      "octavo build t.obj -o t.octv -r 16 --rule thin --origin 0,0,0.25 "
                      "--voxel-size 0.5 -q");
        EXPECT_EQ(built.code, 0) << built.err;
    }
    std::string ask(const std::string& question) {
        const Outcome outcome = run_shell(folder.path(), "octavo query t.octv " + question);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return outcome.out;
    }

    TemporaryFolder folder;
};

TEST_F(Query, AnswersForPointsInWorldUnits) {
    EXPECT_EQ(ask("--point 1.75,1.75,1"), "voxel 3,3,1 is set\n");
    EXPECT_EQ(ask("--point 1.75,1.75,3"), "voxel 3,3,5 is empty\n");
    EXPECT_EQ(ask("--point -1.75,1.75,3"), "outside the grid\n");
    EXPECT_EQ(ask("--point 8,8,8"), "outside the grid\n");
    const Json json = Json::parse(ask("--point 1.75,1.75,1 --json"));
    EXPECT_EQ(json.at("inside"), true);
    EXPECT_EQ(json.at("set"), true);
    EXPECT_EQ(json.at("voxel"), Json({3, 3, 1}));
}

TEST_F(Query, AnswersForRaysInWorldUnits) {
    // Down the z axis on to the voxel's upper face, at 0.25 + 2 * 0.5.
    const Json hit = Json::parse(ask("--ray 1.75,1.75,9.25,0,0,-2 --json"));
    EXPECT_EQ(hit.at("hit"), true);
    EXPECT_DOUBLE_EQ(hit.at("t").get<double>(), 4.0);
    EXPECT_EQ(hit.at("voxel"), Json({3, 3, 1}));
    EXPECT_EQ(hit.at("normal"), Json({0.0, 0.0, 1.0}));
    EXPECT_DOUBLE_EQ(hit.at("position").at(2).get<double>(), 1.25);
    EXPECT_EQ(Json::parse(ask("--ray 1.75,1.75,9,0,0,1 --json")).at("hit"), false);
    EXPECT_EQ(ask("--ray 1.75,1.75,9,0,0,1"), "the ray hits nothing\n");
}

}  // namespace
}  // namespace octavo::test
