// SPDX-License-Identifier: MIT
#include "octavo/io/metadata.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "io/small_model.h"
#include "octavo/core/error.h"

namespace octavo {
namespace {

/// What decode_metadata says about a text, or an empty text where it takes it.
std::string refusal(const std::string& json) {
    try {
        (void)decode_metadata(json);
        return {};
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::bad_input);
        return error.what();
    }
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from << " is not in " << text;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST(Metadata, SurvivesTheRoundTripExactly) {
    Metadata metadata = test::small_model().metadata;
    metadata.source = "ein Häuschen.glb";
    metadata.rule = VoxelRule::thin;
    metadata.grid.origin = {5.7e6 + 1.0 / 3.0, -0.1, std::numeric_limits<double>::denorm_min()};
    metadata.grid.voxel_size = 1.0 / 7.0;
    const std::string json = encode_metadata(metadata);
    const Metadata back = decode_metadata(json);

    EXPECT_EQ(back.source, metadata.source);
    EXPECT_EQ(back.rule, VoxelRule::thin);
    EXPECT_EQ(back.grid, metadata.grid);
    EXPECT_EQ(back.triangles, 12u);
    EXPECT_EQ(back.degenerate_triangles, 2u);
    EXPECT_EQ(back.non_finite_triangles, 1u);
    EXPECT_EQ(back.statistics.voxels, metadata.statistics.voxels);
    EXPECT_EQ(back.statistics.svo_nodes, metadata.statistics.svo_nodes);
    EXPECT_EQ(back.statistics.dag_nodes, metadata.statistics.dag_nodes);
    EXPECT_EQ(back.statistics.dag_bytes, metadata.statistics.dag_bytes);
    ASSERT_EQ(back.cameras.size(), 1u);
    EXPECT_EQ(back.cameras[0].name, "front \"A\"");
    EXPECT_EQ(back.cameras[0].eye, metadata.cameras[0].eye);
    ASSERT_EQ(back.lights.size(), 1u);
    EXPECT_EQ(back.lights[0].kind, Light::Kind::spot);
    EXPECT_EQ(back.lights[0].intensity, metadata.lights[0].intensity);
    EXPECT_EQ(encode_metadata(back), json);
}

TEST(Metadata, KeepsLampsWithAnArea) {
    Metadata metadata = test::small_model().metadata;
    Light rectangle;
    rectangle.kind = Light::Kind::rectangle;
    rectangle.half_u = {0.1, 0, 2};
    rectangle.half_v = {0, 1.0 / 3.0, 0};
    Light disc;
    disc.kind = Light::Kind::disc;
    disc.size = 0.7;
    Light mesh;
    mesh.kind = Light::Kind::mesh;
    mesh.triangles = {{dvec3(1, 2, 3), dvec3(0.1, 0.2, 0.3), dvec3(7, 8, 9)}, {}};
    metadata.lights = {rectangle, disc, mesh};
    const std::string json = encode_metadata(metadata);
    const Metadata back = decode_metadata(json);
    ASSERT_EQ(back.lights.size(), 3u);
    EXPECT_EQ(back.lights[0].half_u, rectangle.half_u);
    EXPECT_EQ(back.lights[0].half_v, rectangle.half_v);
    EXPECT_EQ(back.lights[1].size, 0.7);
    EXPECT_EQ(back.lights[2].triangles, mesh.triangles);
    EXPECT_EQ(encode_metadata(back), json);
    EXPECT_NE(refusal(replaced(json, R"("triangles":[1.0,)", R"("triangles":[)")), "");
    EXPECT_NE(refusal(replaced(json, R"("size":0.7)", R"("size":-0.7)")), "");
}

TEST(Metadata, KeepsTheFileReadableWhateverANameHolds) {
    Metadata metadata = test::small_model().metadata;
    metadata.source = "\xff\xfe broken";
    EXPECT_NO_THROW((void)decode_metadata(encode_metadata(metadata)));
}

TEST(Metadata, RefusesToWriteWhatCannotBeRead) {
    Metadata metadata = test::small_model().metadata;
    metadata.cameras[0].eye.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW((void)encode_metadata(metadata), Error);
}

TEST(Metadata, PassesOverFieldsItDoesNotKnow) {
    const std::string json = encode_metadata(test::small_model().metadata);
    EXPECT_EQ(refusal(replaced(json, "{", R"({"later":[1,{"a":null}],)")), "");
}

TEST(Metadata, NamesTheFieldThatIsWrong) {
    const std::string json = encode_metadata(test::small_model().metadata);
    const auto refusal_of = [&](const std::string& from, const std::string& to) {
        return refusal(replaced(json, from, to));
    };
    EXPECT_EQ(refusal_of(R"("rule":"conservative")", R"("rule":"thick")"),
              "metadata: /rule is not a rule that this program knows");
    EXPECT_EQ(refusal_of(R"("voxel_size":0.1)", R"("voxel_size":0)"),
              "metadata: /grid/voxel_size is not above 0");
    EXPECT_EQ(refusal_of(R"("voxel_size":0.1)", R"("voxel_size":1e308)"),
              "metadata: /grid reaches past the largest number");
    EXPECT_EQ(refusal_of(R"("voxel_size":0.1)", R"("voxel_size":"0.1")"),
              "metadata: /grid/voxel_size is not a number");
    EXPECT_EQ(refusal_of(R"("depth":4)", R"("depth":18)"),
              "metadata: /grid/depth is 18; at most 17 is possible");
    EXPECT_EQ(refusal_of(R"("depth":4)", R"("depth":-1)"), "metadata: /grid/depth is not a count");
    EXPECT_EQ(refusal_of(R"("depth":4)", R"("depth":1)"), "metadata: /grid/depth is below 2");
    EXPECT_EQ(refusal_of(R"("depth":4)", R"("depth":5)"),
              "metadata: /levels has 4 entries, and the depth is 5");
    EXPECT_EQ(refusal_of(R"("origin":[-1.0,)", R"("origin":[)"),
              "metadata: /grid/origin does not have three numbers");
    EXPECT_EQ(refusal_of(R"("kind":"spot")", R"("kind":"moon")"),
              "metadata: /lights/0/kind is not sun, point, spot, disc, rectangle or mesh");
    EXPECT_EQ(refusal_of(R"("degenerate":2)", R"("degenerate":13)"),
              "metadata: /triangles/degenerate is 13; at most 12 is possible");
    EXPECT_EQ(refusal_of(R"("source":)", R"("sauce":)"), "metadata: /source is missing");
}

TEST(Metadata, RefusesCountsThatTheDepthCannotHold) {
    const std::string json = encode_metadata(test::small_model().metadata);
    const std::string huge = "18446744073709551615";
    for (const std::string field : {"voxels", "svo_nodes", "dag_nodes", "words"}) {
        const std::size_t at = json.find("\"" + field + "\":") + field.size() + 3;
        const std::size_t end = json.find_first_of(",}", at);
        const std::string text = json.substr(0, at) + huge + json.substr(end);
        EXPECT_NE(refusal(text).find(field + " is " + huge), std::string::npos) << refusal(text);
    }
}

TEST(Metadata, RefusesWhatIsNotItsJson) {
    EXPECT_NE(refusal(""), "");
    EXPECT_NE(refusal("null"), "");
    EXPECT_NE(refusal("[]"), "");
    EXPECT_NE(refusal("{\"source\":1e999}"), "");
    EXPECT_NE(refusal("{} trailing"), "");
    EXPECT_EQ(refusal(std::string(100'000, '[')), "metadata: the JSON is nested too deep");
    std::string many = "[0";
    for (int i = 0; i < 1'000'001; ++i) many += ",0";
    EXPECT_EQ(refusal(many + "]"), "metadata: the JSON has too many values");
}

}  // namespace
}  // namespace octavo
