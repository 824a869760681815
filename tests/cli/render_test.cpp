// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "cli/run_command.h"
#include "octavo/io/octv.h"
#include "octavo/render/render.h"
#include "octavo/trace/trace.h"
#include "support/lamps.h"

namespace octavo::test {
namespace {

Light sun_towards(const dvec3& direction) {
    Light sun;
    sun.name = "east";
    sun.direction = glm::normalize(direction);
    sun.intensity = vec3(2.0f);
    return sun;
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
const Light kLamp = test::lamp_at({-11, 4, 0}, 50.0f);

TEST(RenderLight, IsThatOfTheFile) {
    EXPECT_TRUE(picture({kMorning}) != picture({kEvening}));
    EXPECT_TRUE(picture({kLamp, kMorning, kEvening}) != picture({kMorning}));
    EXPECT_TRUE(picture({kLamp, kMorning}) == picture({kLamp, kMorning}, "--light scene"));
    EXPECT_TRUE(picture({kLamp, kMorning}, "--light scene=east") ==
                picture({kMorning}, "--light scene"));
}

TEST(RenderLight, IsALampWhereThereIsNoSun) {
    EXPECT_TRUE(picture({kLamp}) != picture({}));
    EXPECT_TRUE(picture({kLamp}) != picture({test::lamp_at({-11, 1, 0}, 50.0f)}));
}

TEST(RenderCamera, SaysWhoseItIsAndWhatIsWrongWithIt) {
    const TemporaryFolder folder;
    Model model = read_octv(small_octv());
    const Box box = framed_box(model.dag, model.grid());
    Camera camera = default_camera(box, {0.0, 1.0, 0.0}, 16.0 / 9.0);
    camera.name = "porch";
    model.metadata.cameras = {camera};
    write_octv(folder / "a.octv", model);
    const auto says = [&](const std::string& options) {
        const Outcome outcome = run_shell(
            folder.path(), "octavo render a.octv -o a.png -f --size 16x9 --ao 0 " + options);
        EXPECT_EQ(outcome.code, 0);
        return outcome.err;
    };
    EXPECT_NE(says("").find("seen by the file's camera 'porch'; --overview"), std::string::npos);
    for (const char* asked : {"--camera porch", "--overview", "-q"})
        EXPECT_EQ(says(asked).find("porch"), std::string::npos) << asked;
    EXPECT_NE(says("--eye 0,1e5,0 --at 1,2e5,0").find("sees next to nothing"), std::string::npos);

    const Ray down{.origin = box.centre() + dvec3(0, box.size().y, 0), .direction = {0, -1, 0}};
    const Hit hit = trace_closest(model.dag, model.grid(), down);
    ASSERT_TRUE(hit);
    const Grid grid = model.grid();
    model.metadata.cameras[0].eye = grid.origin + grid.voxel_size * (dvec3(hit.path) + 0.5);
    write_octv(folder / "a.octv", model);
    const std::string said = says("");
    EXPECT_NE(said.find("'porch' stands in a full voxel"), std::string::npos) << said;
}

TEST(RenderAmbient, StopsAtAnAngleOnlyWhereItIsAskedFor) {
    const TemporaryFolder folder;
    const std::string render = "octavo render " + small_octv().string() + " --size 48x27 --ao 16 ";
    ASSERT_EQ(run_shell(folder.path(), render + "-o a.png").code, 0);
    ASSERT_EQ(run_shell(folder.path(), render + "-o b.png --ao-cone 0").code, 0);
    ASSERT_EQ(run_shell(folder.path(), render + "-o c.png --ao-cone 30").code, 0);
    EXPECT_TRUE(file_content(folder / "a.png") == file_content(folder / "b.png"));
    EXPECT_TRUE(file_content(folder / "a.png") != file_content(folder / "c.png"));
}

TEST(RenderPrimary, ShowsTheTrianglesInTheVoxelsShadow) {
    const TemporaryFolder folder;
    write_octv(folder / "a.octv", read_octv(small_octv()));
    const std::string mesh = "octavo render sample:courtyard -o mesh.png --size 96x54 --ao 16 ";
    const Outcome outcome = run_shell(folder.path(), mesh + "--primary mesh --dag a.octv");
    if (outcome.err.find("built without Embree") != std::string::npos)
        GTEST_SKIP() << "no Embree (libembree-dev)";
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    ASSERT_EQ(
        run_shell(folder.path(), "octavo render a.octv -o voxels.png --size 96x54 --ao 16").code,
        0);
    EXPECT_TRUE(file_content(folder / "mesh.png") != file_content(folder / "voxels.png"));
    EXPECT_EQ(run_shell(folder.path(), mesh + "-f --primary mesh").code, 2);
    EXPECT_EQ(run_shell(folder.path(), "octavo render a.octv -o b.png --dag a.octv").code, 2);
}

TEST(RenderNoWide, IsTheSamePicture) {
    const TemporaryFolder folder;
    const auto build =
        run_shell(folder.path(),
                  "octavo build sample:courtyard -o a.octv -r 128 -q --attributes color "
                  "--attribute-resolution 32; octavo build sample:courtyard -o b.octv -r 64 -q "
                  "--attributes color --attribute-resolution 32");
    ASSERT_EQ(build.code, 0) << build.err;
    folder.write("scene.json", R"({"objects":[{"file":"a.octv"},
        {"file":"b.octv","scale":0.2,"position":[1,2,3],"rotation":{"degrees":30}}],
        "lights":["sun:30,60"],"sky":"none"})");
    const std::string end = " -o a.png --size 48x27 --samples 2 --ao 8 --shadow-samples 4 -f";
    for (const std::string file :
         {"a.octv", "a.octv --gi", "a.octv --gi cached --sun 30,60", "scene.json"}) {
        const Outcome wide = run_shell(folder.path(), "octavo render " + file + end);
        ASSERT_EQ(wide.code, 0) << file << wide.err;
        const std::string picture = file_content(folder / "a.png");
        ASSERT_EQ(run_shell(folder.path(), "octavo render " + file + " --no-wide" + end).code, 0);
        EXPECT_TRUE(file_content(folder / "a.png") == picture) << file;
    }
    EXPECT_EQ(run_shell(folder.path(), "octavo render a.octv --no-wide --device vulkan" + end).code,
              2);
}

TEST(RenderLight, IsTheOneThatWasAskedFor) {
    EXPECT_TRUE(picture({kMorning}, "--sun 30,40") == picture({}, "--sun 30,40"));
    EXPECT_TRUE(picture({kMorning}, "--sun 30,40") != picture({kMorning}));
}

TEST(RenderLight, ComesFromEveryLightThatWasAskedFor) {
    const std::string one = picture({}, "--light point:-11,4,0");
    const std::string two = picture({}, "--light point:-11,4,0 --light sun:30,40");
    EXPECT_TRUE(one != two);
    EXPECT_TRUE(two != picture({}, "--light sun:30,40"));
    EXPECT_TRUE(picture({}, "--sun 30,40") == picture({}, "--light sun:30,40"));
    EXPECT_TRUE(picture({}, "--light point:-11,4,0:power=1:color=3,3,3") == one);
    EXPECT_TRUE(picture({}, "--light point:-11,4,0:power=2") != one);
    EXPECT_TRUE(picture({kMorning}, "--light none") == picture({kEvening}, "--light none"));
    std::string last = one;
    for (const char* lamp : {"spot:-11,4,0:to=0,0,0:angle=40", "disc:-11,4,0:to=0,0,0:size=0.5",
                             "rectangle:-11,4,0:to=0,0,0:size=3x2"}) {
        const std::string next = picture({}, std::string("--light ") + lamp);
        EXPECT_TRUE(next != last) << lamp;
        last = next;
    }
}

TEST(RenderLight, IsRefusedWhereItMakesNoSense) {
    const TemporaryFolder folder;
    Model dark = read_octv(small_octv());
    dark.metadata.lights.clear();
    write_octv(folder / "a.octv", dark);
    for (const char* light :
         {"moon:1,2,3", "sun", "sun:1", "point:1,2", "disc:0,1,0:size=1", "disc:0,1,0:to=0,0,0",
          "disc:0,1,0:to=0,1,0:size=1", "rectangle:0,1,0:to=0,0,0:size=3", "point:0,1,0:angle=3",
          "point:0,1,0:size", "point:0,1,0:color=0,0,0", "spot:0,1,0:to=0,0,0:angle=90",
          "scene=nobody", "scene"}) {
        const Outcome outcome =
            run_shell(folder.path(),
                      std::string("octavo render a.octv -o a.png --size 8x8 --light ") + light);
        EXPECT_EQ(outcome.code, 2) << light << outcome.err;
    }
}

TEST(RenderLight, IsAsBrightInCandelaAsInNothingAtAll) {
    EXPECT_TRUE(picture({kLamp}) == picture({test::lamp_at({-11, 4, 0}, 51200.0f)}));
}

}  // namespace
}  // namespace octavo::test
