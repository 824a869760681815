// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "cli/run_command.h"
#include "octavo/io/octv.h"

namespace octavo::test {
namespace {

Light sun_towards(const dvec3& direction) {
    Light sun;
    sun.direction = glm::normalize(direction);
    sun.intensity = vec3(2.0f);
    return sun;
}

Light lamp_at(const dvec3& position, float intensity) {
    Light lamp;
    lamp.kind = Light::Kind::point;
    lamp.position = position;
    lamp.intensity = vec3(intensity);
    return lamp;
}

/// The bytes of a small picture of the sample's DAG with these lights in its file.
std::string picture(const std::vector<Light>& lights, const std::string& options = "") {
    const TemporaryFolder folder;
    Model model = read_octv(small_octv());
    model.metadata.lights = lights;
    write_octv(folder / "a.octv", model);
    const Outcome outcome =
        run_shell(folder.path(), "octavo render a.octv -o a.png --size 48x27 --ao 0 " + options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return file_content(folder / "a.png");
}

const Light kMorning = sun_towards({1, -1, -0.5});
const Light kEvening = sun_towards({-1, -1, 0.5});
const Light kLamp = lamp_at({-11, 4, 0}, 50.0f);

TEST(RenderLight, IsTheFirstSunOfTheFile) {
    EXPECT_TRUE(picture({kMorning}) != picture({kEvening}));
    EXPECT_TRUE(picture({kLamp, kMorning, kEvening}) == picture({kMorning}));
}

TEST(RenderLight, IsALampWhereThereIsNoSun) {
    EXPECT_TRUE(picture({kLamp}) != picture({}));
    EXPECT_TRUE(picture({kLamp}) != picture({lamp_at({-11, 1, 0}, 50.0f)}));
}

TEST(RenderLight, IsTheOneThatWasAskedFor) {
    EXPECT_TRUE(picture({kMorning}, "--sun 30,40") == picture({}, "--sun 30,40"));
    EXPECT_TRUE(picture({kMorning}, "--sun 30,40") != picture({kMorning}));
}

TEST(RenderLight, IsAsBrightInCandelaAsInNothingAtAll) {
    EXPECT_TRUE(picture({kLamp}) == picture({lamp_at({-11, 4, 0}, 51200.0f)}));
}

}  // namespace
}  // namespace octavo::test
