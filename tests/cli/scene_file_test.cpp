// SPDX-License-Identifier: MIT
// Files that name other files: scenes, camera paths, skies of lit files.
#include <gtest/gtest.h>

#include "cli/run_command.h"
#include "octavo/io/octv.h"

namespace octavo::test {
namespace {

std::string sky_picture_bytes(char brightness) {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + std::string(2, brightness) +
           std::string("\x10\x81", 2) + std::string(2, brightness) + std::string("\x10\x81", 2);
}

class SceneFiles : public testing::Test {
protected:
    SceneFiles() {
        folder.write("in/scene.json", "");
        folder.write("sky.hdr", sky_picture_bytes('\x60'));
        folder.write("in/sky.hdr", sky_picture_bytes('\x60'));
        const Outcome built =
            run("octavo build sample:courtyard -o in/a.octv -r 32 -q --attributes color "
                "--attribute-resolution 16; cp in/a.octv outside.octv; mkfifo in/pipe.octv "
                "in/pipe.hdr; ln -s /dev/zero in/zero.hdr; ln -s ../outside.octv in/link.octv");
        EXPECT_EQ(built.code, 0) << built.err;
    }
    [[nodiscard]] Outcome run(const std::string& line) const {
        return run_shell(folder.path(), line);
    }
    [[nodiscard]] Outcome render(const std::string& json) const {
        folder.write("in/scene.json", json);
        return run(
            "timeout 60 octavo render in/scene.json -o a.png --size 8x8 --samples 1 --ao 1 "
            "--bounces 0 -f -q");
    }
    static std::string scene(const std::string& rest, const std::string& file = "a.octv") {
        return R"({"objects":[{"file":")" + file + R"("}])" + rest + "}";
    }
    TemporaryFolder folder;
};

TEST_F(SceneFiles, ThatAreRightAreRendered) {
    for (const std::string& json :
         {scene(""), scene(R"(,"sky":"sky.hdr:power=2:turn=30","lights":[])"),
          scene(R"(,"sky":"none","lights":["sun:30,60"],"camera":{"eye":[9,9,9],"at":[0,1,0]})")}) {
        const Outcome outcome = render(json);
        EXPECT_EQ(outcome.code, 0) << json << outcome.err;
    }
}

TEST_F(SceneFiles, FaultsAreBadInputWithTheirFile) {
    for (const std::string& json :
         {scene(R"(,"lights":["foo"])"), scene(R"(,"lights":["scene=nobody"])"),
          scene(R"(,"lights":["point:0,1,0:power=nan"])"), scene(R"(,"lights":[1])"),
          scene(R"(,"sky":"blue")"), scene(R"(,"sky":"color:-1,0,0")"),
          scene(R"(,"camera":{"eye":[1,2,3],"at":[1,2,3]})"),
          scene(R"(,"camera":{"eye":[1,2,3],"at":[0,0,0],"fov":500})"),
          scene(R"(,"camera":{"eye":[1,2,3]})"),
          std::string(R"({"objects":[{"file":"a.octv","scale":1e308}]})"),
          std::string(R"({"objects":[{"file":"a.octv","scale":1e-320}]})"),
          std::string(R"({"objects":[{"file":"a.octv","rotation":{"axis":[0,0,0]}}]})"),
          std::string("{\"objects\":"), std::string("\xff"), std::string(100000, '['),
          scene(R"(,"sky":"clear","sky2":1)")}) {
        const Outcome outcome = render(json);
        EXPECT_EQ(outcome.code, 3) << json.substr(0, 200) << outcome.err;
        EXPECT_EQ(lines_in(outcome.err), 1) << outcome.err;
        EXPECT_NE(outcome.err.find("scene.json"), std::string::npos) << outcome.err;
        EXPECT_EQ(outcome.err.find("json.exception"), std::string::npos) << outcome.err;
    }
}

TEST_F(SceneFiles, NameNoFileOutsideTheirFolder) {
    for (const std::string& json :
         {scene("", "../outside.octv"), scene("", "link.octv"), scene("", "/etc/passwd"),
          scene("", ""), scene("", (folder / "outside.octv").string()),
          scene(R"(,"sky":"../sky.hdr")"), scene(R"(,"sky":"zero.hdr")"),
          scene(R"(,"sky":")" + (folder / "sky.hdr").string() + R"(:power=2")")}) {
        const Outcome outcome = render(json);
        EXPECT_EQ(outcome.code, 3) << json << outcome.err;
        EXPECT_NE(outcome.err.find("scene.json: "), std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find("outside"), std::string::npos) << outcome.err;
    }
}

TEST_F(SceneFiles, ThatReadPipesAndDevicesEnd) {
    for (const std::string& json : {scene("", "pipe.octv"), scene(R"(,"sky":"pipe.hdr")")})
        EXPECT_EQ(render(json).code, 3) << json;
    for (const char* line :
         {"octavo render in/a.octv -o b.png --sky in/pipe.hdr",
          "octavo render in/a.octv -o b.png --sky in/zero.hdr",
          "octavo light in/a.octv --sky in/zero.hdr", "octavo render in/pipe.json -o b.png",
          "octavo info in/pipe.octv", "octavo view in/pipe.octv", "octavo validate in/pipe.octv",
          "octavo query in/zero.hdr --point 0,0,0", "octavo build in/pipe.obj -r 16 -o b.octv",
          "octavo info .",
          "octavo bench trace in/a.octv --frames 1 --size 8 --threads 1 --path in/pipe.json",
          "octavo bench trace in/a.octv --frames 1 --size 8 --threads 1 --path in"}) {
        const Outcome outcome =
            run(std::string("cd in; test -p pipe.json || mkfifo pipe.json pipe.obj; cd ..; timeout "
                            "60 ") +
                line);
        EXPECT_EQ(outcome.code, 3) << line << outcome.err;
        EXPECT_NE(outcome.err.find("not a regular file"), std::string::npos) << outcome.err;
    }
}

TEST_F(SceneFiles, HaveAtMostTenThousandObjects) {
    std::string objects = R"({"file":"a.octv"})";
    for (int i = 0; i < 10'000; ++i) objects += R"(,{"file":"a.octv"})";
    const Outcome outcome = render(R"({"objects":[)" + objects + "]}");
    EXPECT_EQ(outcome.code, 4) << outcome.err;
    EXPECT_EQ(lines_in(outcome.err), 1);
}

TEST_F(SceneFiles, OfCameraPathsNameWhatIsWrong) {
    for (const char* json :
         {"", "[]", "{}", R"({"cameras":[]})", R"({"cameras":[{"eye":[0,0,0],"at":[0,0,0]}]})",
          R"({"frames":0,"cameras":[{"eye":[0,0,0],"at":[1,0,0]}]})",
          R"({"frames":1e300,"cameras":[{"eye":[0,0,0],"at":[1,0,0]}]})",
          R"({"closed":1,"cameras":[{"eye":[0,0,0],"at":[1,0,0]}]})",
          R"({"cameras":[{"eye":[0,0],"at":[1,0,0]}]})",
          R"({"cameras":[{"eye":[0,0,0],"at":[1,0,0],"fov":-5}]})"}) {
        folder.write("path.json", json);
        const Outcome outcome =
            run("octavo bench trace in/a.octv --frames 1 --size 8 --threads 1 --path path.json");
        EXPECT_EQ(outcome.code, 3) << json << outcome.err;
        EXPECT_NE(outcome.err.find("path.json: not a camera path: "), std::string::npos)
            << outcome.err;
        EXPECT_EQ(outcome.err.find("json.exception"), std::string::npos) << outcome.err;
    }
}

/// A file that is lit by a picture names it, and a stranger may have written the name.
TEST_F(SceneFiles, SkyOfALitFileIsTakenFromItsFolderOrWhereItIsNamed) {
    const std::string render =
        "octavo render in/a.octv -o a.png --size 8x8 --samples 1 -q -f "
        "--gi cached ";
    ASSERT_EQ(run("octavo light in/a.octv --sky in/sky.hdr:power=2 --rays 1 -q").code, 0);
    EXPECT_EQ(read_octv(folder / "in/a.octv").metadata.light->sky, "sky.hdr:power=2");
    EXPECT_EQ(run(render).code, 0);
    const std::string inside = file_content(folder / "a.png");

    ASSERT_EQ(run("octavo light in/a.octv --sky sky.hdr:power=2 --rays 1 -q").code, 0);
    EXPECT_EQ(read_octv(folder / "in/a.octv").metadata.light->sky, "../sky.hdr:power=2");
    const Outcome refused = run(render);
    EXPECT_EQ(refused.code, 3) << refused.err;
    EXPECT_NE(refused.err.find("in/a.octv: "), std::string::npos) << refused.err;
    EXPECT_NE(refused.err.find("--sky"), std::string::npos) << refused.err;
    EXPECT_EQ(run(render + "--sky sky.hdr:power=2").code, 0);
    EXPECT_TRUE(file_content(folder / "a.png") == inside);
}

}  // namespace
}  // namespace octavo::test
