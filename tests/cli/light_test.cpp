// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/run_command.h"
#include "octavo/io/octv.h"

namespace octavo::test {
namespace {

/// A folder with the small courtyard a.octv, with colours and light.
class LitFile : public testing::Test {
protected:
    LitFile() {
        const Outcome built =
            run("build sample:courtyard -o a.octv --resolution 32 -q "
                "--attributes color,emission --attribute-resolution 16");
        EXPECT_EQ(built.code, 0) << built.err;
        const Outcome lit =
            run("light a.octv --sun 30,60 --sky color:1,1,1 --rays 4 --bounces 1 -q");
        EXPECT_EQ(lit.code, 0) << lit.err;
    }
    [[nodiscard]] Outcome run(const std::string& arguments) const {
        return run_shell(folder.path(), "octavo " + arguments);
    }
    [[nodiscard]] std::string picture(const std::string& arguments) const {
        const Outcome outcome =
            run("render " + arguments + " -o a.png --size 24x16 --samples 1 --ao 4 -f -q");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return file_content(folder / "a.png");
    }
    TemporaryFolder folder;
};

TEST_F(LitFile, KnowsItsLightsAndSky) {
    const Model model = read_octv(folder / "a.octv");
    EXPECT_EQ(model.light.count(), model.attributes.cells().count());
    EXPECT_EQ(model.metadata.light->sky, "color:1,1,1");
    EXPECT_EQ(model.metadata.light->bounces, 1);
}

TEST_F(LitFile, IsDescribedByInfo) {
    const Outcome table = run("info a.octv");
    EXPECT_EQ(table.code, 0) << table.err;
    for (const char* said : {"stored light", "bounces     1", "lamps       sun", "color:1,1,1"})
        EXPECT_TRUE(table.out.find(said) != std::string::npos) << said << " in\n" << table.out;
    const auto json = nlohmann::json::parse(run("info a.octv --json").out).at("light");
    const Model model = read_octv(folder / "a.octv");
    EXPECT_EQ(json.at("bytes"), model.light.words().size_bytes());
    EXPECT_EQ(json.at("bounces"), 1);
    EXPECT_EQ(json.at("lamps").at(0).at("kind"), "sun");
}

TEST_F(LitFile, GivesThreeDifferentPictures) {
    const std::string gathered = picture("a.octv --gi");
    const std::string cached = picture("a.octv --gi cached");
    const std::string reference = picture("a.octv --reference");
    EXPECT_TRUE(gathered != cached);
    EXPECT_TRUE(gathered != reference);
    EXPECT_TRUE(gathered == picture("a.octv --gi"));
    EXPECT_TRUE(cached != picture("a.octv --gi cached --sun 90,30 --bounces 0"));
    EXPECT_TRUE(gathered != picture("a.octv --gi --sky none"));
    EXPECT_TRUE(reference != picture("a.octv --reference --frame 1"));
}

TEST_F(LitFile, SaysWhenCellsAreLitForOnePictureAlone) {
    const auto said = [this](const std::string& arguments) {
        const Outcome outcome =
            run("render " + arguments + " -o b.png --size 8x8 --samples 1 --ao 4 -f");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        return outcome.err;
    };
    const auto has = [](const std::string& text, const char* what) {
        return text.find(what) != std::string::npos;
    };
    EXPECT_FALSE(has(said("a.octv --gi cached"), "lighting"));
    const std::string other = said("a.octv --gi --sun 90,30");
    EXPECT_TRUE(has(other, "of other lamps")) << other;
    EXPECT_TRUE(has(other, "octavo light a.octv")) << other;
    ASSERT_EQ(run("build sample:courtyard -o bare.octv --resolution 32 -q --attributes color "
                  "--attribute-resolution 16")
                  .code,
              0);
    for (const std::string gi : {"--gi", "--gi cached"}) {
        const std::string text = said("bare.octv " + gi + " --bounces 0");
        EXPECT_TRUE(has(text, "no light is stored in bare.octv")) << text;
        EXPECT_TRUE(has(text, "octavo light bare.octv")) << text;
    }
    EXPECT_FALSE(has(said("bare.octv --reference"), "lighting"));
    EXPECT_EQ(said("bare.octv --gi cached --bounces 0 -q"), "");
}

TEST_F(LitFile, TheSkyOfAPlainPictureCanBeChosen) {
    EXPECT_TRUE(picture("a.octv") != picture("a.octv --sky color:1,0,0"));
    EXPECT_TRUE(picture("a.octv --sky none") !=
                picture("a.octv --sky gradient:zenith=0,0,1:horizon=1,1,1:ground=0,1,0:power=2"));
}

TEST_F(LitFile, ASceneOfSeveralIsRendered) {
    std::ofstream(folder / "scene.json")
        << R"({"objects":[{"file":"a.octv"},{"file":"a.octv","position":[0,9,0],"scale":0.25,)"
           R"("rotation":{"axis":[0,1,0],"degrees":30}}],"lights":["sun:30,60"],"sky":"clear",)"
           R"("camera":{"eye":[40,30,40],"at":[0,5,0],"fov":50}})";
    std::ofstream(folder / "one.json")
        << R"({"objects":[{"file":"a.octv"}],"lights":["sun:30,60"],"sky":"clear",)"
           R"("camera":{"eye":[40,30,40],"at":[0,5,0],"fov":50}})";
    EXPECT_TRUE(picture("scene.json --bounces 0") != picture("one.json --bounces 0"));
}

TEST_F(LitFile, SceneFilesThatAreWrongAreNamed) {
    for (const char* text :
         {"", "[]", "{}", R"({"objects":[]})", R"({"objects":[{}]})", R"({"objects":[{"file":7}]})",
          R"({"objects":[{"file":"a.octv","scale":0}]})",
          R"({"objects":[{"file":"a.octv","colour":1}]})",
          R"({"objects":[{"file":"a.octv","position":[1,2]}]})",
          R"({"objects":[{"file":"a.octv"}],"lights":3})"}) {
        std::ofstream(folder / "bad.json") << text;
        const Outcome outcome = run("render bad.json -o b.png -q");
        EXPECT_EQ(outcome.code, 3) << text << outcome.err;
        EXPECT_NE(outcome.err.find("bad.json"), std::string::npos) << outcome.err;
    }
}

TEST_F(LitFile, WrongArgumentsAreRefused) {
    for (const char* arguments :
         {"light a.octv --sky blue -q", "light a.octv --bounces 9 -q",
          "light a.octv --sky color:1,2 -q", "light a.octv --sky clear:turn=3 -q",
          "render a.octv -o b.png --gi backwards -q", "render a.octv -o b.png --gi --no-color -q"})
        EXPECT_EQ(run(arguments).code, 2) << arguments;
    EXPECT_EQ(run("build sample:courtyard -o plain.octv --resolution 32 -q").code, 0);
    EXPECT_EQ(run("light plain.octv -q").code, 2);
    EXPECT_EQ(run("render plain.octv -o b.png --gi -q").code, 2);
}

}  // namespace
}  // namespace octavo::test
