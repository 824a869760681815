// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "mesh/gltf_file.h"

namespace octavo {
namespace {

using nlohmann::json;
using test::GltfFile;
using test::load_error;
using test::mentions;
using test::raw;
using test::TemporaryFolder;

GltfFile with_triangle() {
    GltfFile file;
    const int position = file.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    file.root["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", position}}}}}}}};
    file.root["nodes"] = {{{"mesh", 0}}};
    return file;
}

TEST(Gltf, AppliesNestedNodesInDouble) {
    const TemporaryFolder folder;
    GltfFile file = with_triangle();
    const double half = std::sqrt(0.5);
    file.root["nodes"] = {
        {{"translation", {5700000.123456789, 0, 0}}, {"children", {1, 2}}},
        {{"mesh", 0}, {"scale", {0.001, 2, 1}}},
        {{"mesh", 0}, {"rotation", {0, 0, half, half}}},  // a quarter turn about z
        {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1}}},
    };
    const Scene scene = load_scene(file.write(folder));
    ASSERT_EQ(scene.triangles.size(), 3u);
    EXPECT_EQ(scene.corners(0)[1], dvec3(5700000.123456789 + 0.001, 0, 0));
    EXPECT_EQ(scene.corners(0)[2], dvec3(5700000.123456789, 2, 0));
    EXPECT_NEAR(glm::distance(scene.corners(1)[1], dvec3(5700000.123456789, 1, 0)), 0, 1e-9);
    EXPECT_EQ(scene.corners(2)[2], dvec3(7, 9, 9));
}

TEST(Gltf, ShowsAMeshAtEachOfItsInstances) {
    const TemporaryFolder folder;
    GltfFile file = with_triangle();
    const int shifts = file.positions({5, 0, 0, 0, 7, 0});
    // None, and a quarter turn about z: (0, 0, sin 45, cos 45), in bytes a little too long.
    const int turns =
        file.accessor(std::vector<std::int8_t>{0, 0, 0, 127, 0, 0, 90, 90}, 5120, "VEC4", 4, true);
    const int scales = file.positions({1, 1, 1, 2, 2, 2});
    const auto instances = [&](const json& attributes) {
        return json{{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}};
    };
    file.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    file.root["nodes"] = {
        {{"mesh", 0},
         {"translation", {0, 0, 1}},
         {"extensions",
          instances({{"TRANSLATION", shifts}, {"ROTATION", turns}, {"SCALE", scales}})}},
        {{"mesh", 0}, {"extensions", instances({{"TRANSLATION", shifts}})}},
        {{"mesh", 0}, {"extensions", instances(json::object())}}};
    const Scene scene = load_scene(file.write(folder));
    EXPECT_EQ(scene.warnings, std::vector<std::string>());
    ASSERT_EQ(scene.triangles.size(), 5u);
    EXPECT_EQ(scene.corners(0)[1], dvec3(6, 0, 1));
    EXPECT_NEAR(glm::distance(scene.corners(1)[1], dvec3(0, 9, 1)), 0, 1e-12);
    EXPECT_NEAR(glm::distance(scene.corners(1)[2], dvec3(-2, 7, 1)), 0, 1e-12);
    EXPECT_EQ(scene.corners(3)[2], dvec3(0, 8, 0));
    EXPECT_EQ(scene.corners(4)[1], dvec3(1, 0, 0));

    file.root["nodes"][0]["extensions"] = instances({{"TRANSLATION", shifts}, {"SCALE", 0}});
    EXPECT_EQ(load_error(file.write(folder)).code(), Errc::bad_input);
}

TEST(Gltf, ShowsOnlyTheNodesOfItsScene) {
    const TemporaryFolder folder;
    GltfFile file = with_triangle();
    file.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}}};
    file.root["scenes"] = {{{"nodes", json::array()}}, {{"nodes", {1}}}};
    file.root["scene"] = 1;
    EXPECT_EQ(load_scene(file.write(folder)).triangles.size(), 1u);
}

TEST(Gltf, ReadsListsStripsAndFansWithEveryIndexType) {
    const TemporaryFolder folder;
    GltfFile file;
    const int position = file.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 2, 0});
    const int bytes = file.accessor<std::uint8_t>({0, 1, 2, 3, 4}, 5121, "SCALAR", 1);
    const int shorts = file.accessor<std::uint16_t>({0, 1, 2, 3, 4}, 5123, "SCALAR", 1);
    const int words = file.accessor<std::uint32_t>({0, 1, 2, 1, 3, 2}, 5125, "SCALAR", 1);
    const json attributes{{"POSITION", position}};
    file.root["meshes"] = {{{"primitives",
                             {{{"attributes", attributes}, {"indices", words}},
                              {{"attributes", attributes}, {"indices", shorts}, {"mode", 5}},
                              {{"attributes", attributes}, {"indices", bytes}, {"mode", 6}},
                              {{"attributes", attributes}, {"mode", 0}}}}}};
    file.root["nodes"] = {{{"mesh", 0}}};
    const Scene scene = load_scene(file.write(folder));
    EXPECT_EQ(scene.triangles, (std::vector<uvec3>{{0, 1, 2},
                                                   {1, 3, 2},  // list
                                                   {0, 1, 2},
                                                   {2, 1, 3},
                                                   {2, 3, 4},  // strip
                                                   {0, 1, 2},
                                                   {0, 2, 3},
                                                   {0, 3, 4}}));  // fan
    EXPECT_EQ(scene.positions.size(), 5u);                        // shared by all of them
    EXPECT_TRUE(mentions(scene, "points or lines"));
}

TEST(Gltf, ReadsQuantisedPositions) {
    const TemporaryFolder folder;
    GltfFile file;
    const int position =
        file.accessor<std::int16_t>({0, 0, 0, 32767, 0, 0, 0, -32768, 0}, 5122, "VEC3", 3, true);
    const int plain =
        file.accessor<std::uint16_t>({0, 0, 0, 65535, 0, 0, 0, 3, 0}, 5123, "VEC3", 3);
    file.root["meshes"] = {
        {{"primitives",
          {{{"attributes", {{"POSITION", position}}}}, {{"attributes", {{"POSITION", plain}}}}}}}};
    file.root["nodes"] = {{{"mesh", 0}, {"scale", {0.5, 0.5, 0.5}}}};
    file.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    const Scene scene = load_scene(file.write(folder));
    EXPECT_EQ(scene.corners(0)[1], dvec3(0.5, 0, 0));
    EXPECT_EQ(scene.corners(0)[2], dvec3(0, -0.5, 0));
    EXPECT_EQ(scene.corners(1)[1], dvec3(32767.5, 0, 0));
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Gltf, AppliesSparseAccessorsWithAndWithoutABase) {
    const TemporaryFolder folder;
    GltfFile file = with_triangle();
    file.accessor<std::uint8_t>({2}, 5121, "SCALAR", 1);
    file.positions({9, 8, 7});
    const json sparse{{"count", 1},
                      {"indices", {{"bufferView", 1}, {"componentType", 5121}}},
                      {"values", {{"bufferView", 2}}}};
    file.root["accessors"][0]["sparse"] = sparse;
    EXPECT_EQ(load_scene(file.write(folder)).positions,
              (std::vector<dvec3>{{0, 0, 0}, {1, 0, 0}, {9, 8, 7}}));
    file.root["accessors"][0].erase("bufferView");
    EXPECT_EQ(load_scene(file.write(folder)).positions,
              (std::vector<dvec3>{{0, 0, 0}, {0, 0, 0}, {9, 8, 7}}));
}

TEST(Gltf, ReadsColoursOfEveryKindAndFillsInWhite) {
    const TemporaryFolder folder;
    GltfFile file;
    const int position = file.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int again = file.positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int floats = file.accessor<float>({1, 0.5f, 0, 0, 0, 1, 2, -1, 0}, 5126, "VEC3", 3);
    const int shorts = file.accessor<std::uint16_t>({65535, 0, 0, 32768, 0, 0, 0, 0, 0, 0, 0, 0},
                                                    5123, "VEC4", 4, true);
    file.root["meshes"] = {{{"primitives",
                             {{{"attributes", {{"POSITION", again}}}},
                              {{"attributes", {{"POSITION", position}, {"COLOR_0", floats}}}},
                              {{"attributes", {{"POSITION", position}, {"COLOR_0", shorts}}}}}}}};
    file.root["nodes"] = {{{"mesh", 0}}};
    const Scene scene = load_scene(file.write(folder));
    using Color = std::array<std::uint8_t, 4>;
    ASSERT_EQ(scene.colors.size(), 9u);
    EXPECT_EQ(scene.colors[0], (Color{255, 255, 255, 255}));
    EXPECT_EQ(scene.colors[3], (Color{255, 128, 0, 255}));
    EXPECT_EQ(scene.colors[5], (Color{255, 0, 0, 255}));
    EXPECT_EQ(scene.colors[6], (Color{255, 0, 0, 128}));
}

TEST(Gltf, ReadsMaterialsTexturesAndTheirPlacement) {
    const TemporaryFolder folder;
    folder.write("tex/wall 1.png", "png");
    GltfFile file = with_triangle();
    const int first = file.accessor<float>({0, 0, 1, 0, 0, 1}, 5126, "VEC2", 2);
    const int second = file.accessor<std::uint8_t>({0, 0, 255, 0, 0, 51}, 5121, "VEC2", 2, true);
    json& primitive = file.root["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_0"] = first;
    primitive["attributes"]["TEXCOORD_1"] = second;
    primitive["material"] = 0;
    file.root["materials"] = {
        {{"name", "leaf"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.5, 0.25, 1, 1}},
           {"baseColorTexture",
            {{"index", 0},
             {"texCoord", 1},
             {"extensions",
              {{"KHR_texture_transform", {{"scale", {2, 10}}, {"offset", {0.5, 0}}}}}}}}}},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.25},
         {"emissiveFactor", {1, 0.5, 0}},
         {"emissiveTexture", {{"index", 1}}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}}};
    file.root["textures"] = {{{"source", 0}}, {{"source", 1}}};
    file.root["images"] = {{{"uri", "tex/wall%201.png"}},
                           {{"uri", "data:image/png;base64,iVBORw=="}}};
    const Scene scene = load_scene(file.write(folder));
    const Material& leaf = scene.materials.at(0);
    EXPECT_EQ(leaf.base_color, vec4(0.5f, 0.25f, 1, 1));
    EXPECT_EQ(leaf.alpha_cutoff, 0.25f);
    EXPECT_EQ(leaf.emission, vec3(8, 4, 0));
    ASSERT_EQ(scene.textures.size(), 2u);
    EXPECT_EQ(scene.textures[0].file, folder.path() / "tex/wall 1.png");
    EXPECT_EQ(scene.textures[1].encoded.size(), 4u);
    EXPECT_EQ(scene.textures[1].encoded[1], std::byte{'P'});
    EXPECT_EQ(leaf.base_color_texture, 0);
    EXPECT_EQ(leaf.emission_texture, 1);
    EXPECT_EQ(scene.texture_coordinates, (std::vector<vec2>{{0.5f, 0}, {2.5f, 0}, {0.5f, 2}}));
    // The emission's picture lies by the other set, and is not moved.
    EXPECT_EQ(scene.emission_coordinates, (std::vector<vec2>{{0, 0}, {1, 0}, {0, 1}}));
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(Gltf, PrimitivesWhoseEmissionLiesLikeTheBaseColourShareTheirCoordinates) {
    const TemporaryFolder folder;
    folder.write("a.png", "png");
    GltfFile file = with_triangle();
    json& primitives = file.root["meshes"][0]["primitives"];
    primitives[0]["attributes"]["TEXCOORD_0"] =
        file.accessor<float>({0, 0, 1, 0, 0, 1}, 5126, "VEC2", 2);
    const json picture{{"index", 0}};
    json moved = picture;
    moved["extensions"]["KHR_texture_transform"]["offset"] = {0.25, 0.5};
    file.root["textures"] = {{{"source", 0}}};
    file.root["images"] = {{{"uri", "a.png"}}};
    const auto material = [](const json& base, const json& emission) {
        return json{{"pbrMetallicRoughness", {{"baseColorTexture", base}}},
                    {"emissiveFactor", {1, 1, 1}},
                    {"emissiveTexture", emission}};
    };
    file.root["materials"] = {material(picture, picture), material(picture, moved),
                              material(moved, moved)};
    primitives.push_back(primitives[0]);
    primitives.push_back(primitives[0]);
    for (int i = 0; i < 3; ++i) primitives[i]["material"] = i;
    const Scene scene = load_scene(file.write(folder));
    const std::vector<vec2> plain{{0, 0}, {1, 0}, {0, 1}};
    const std::vector<vec2> aside{{0.25f, 0.5f}, {1.25f, 0.5f}, {0.25f, 1.5f}};
    ASSERT_EQ(scene.texture_coordinates.size(), 9u);
    ASSERT_EQ(scene.emission_coordinates.size(), 9u);
    const auto of = [](const std::vector<vec2>& all, std::size_t i) {
        const auto first = all.begin() + static_cast<std::ptrdiff_t>(3 * i);
        return std::vector<vec2>(first, first + 3);
    };
    EXPECT_EQ(of(scene.texture_coordinates, 0), plain);
    EXPECT_EQ(of(scene.emission_coordinates, 0), plain);
    EXPECT_EQ(of(scene.texture_coordinates, 1), plain);
    EXPECT_EQ(of(scene.emission_coordinates, 1), aside);
    EXPECT_EQ(of(scene.texture_coordinates, 2), aside);
    EXPECT_EQ(of(scene.emission_coordinates, 2), aside);
}

TEST(Gltf, ReadsCamerasAndLightsWhereTheirNodesStand) {
    const TemporaryFolder folder;
    GltfFile file = with_triangle();
    const double half = std::sqrt(0.5);
    file.root["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 1}}}},
        {{"type", "orthographic"}}};
    file.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "directional"}, {"color", {1, 0.5, 0.25}}, {"intensity", 4}},
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}}};
    const auto light = [](int index) { return json{{"KHR_lights_punctual", {{"light", index}}}}; };
    file.root["nodes"] = {{{"mesh", 0}},
                          {{"name", "eye"}, {"camera", 0}, {"translation", {1, 2, 3}}},
                          {{"camera", 1}},
                          {{"extensions", light(0)}, {"rotation", {-half, 0, 0, half}}},
                          {{"extensions", light(1)}, {"translation", {4, 5, 6}}}};
    const Scene scene = load_scene(file.write(folder));
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].name, "eye");
    EXPECT_EQ(scene.cameras[0].eye, dvec3(1, 2, 3));
    EXPECT_EQ(scene.cameras[0].forward, dvec3(0, 0, -1));
    EXPECT_EQ(scene.cameras[0].vertical_fov, 0.5);
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_NEAR(glm::distance(scene.lights[0].direction, dvec3(0, -1, 0)), 0, 1e-12);
    EXPECT_EQ(scene.lights[0].intensity, vec3(4, 2, 1));
    EXPECT_EQ(scene.lights[1].kind, Light::Kind::spot);
    EXPECT_EQ(scene.lights[1].position, dvec3(4, 5, 6));
    EXPECT_EQ(scene.lights[1].outer_angle, 0.2);
}

TEST(Gltf, RejectsWhatReachesPastItsData) {
    const TemporaryFolder folder;
    const auto rejects = [&](const char* what, auto&& change) {
        GltfFile file = with_triangle();
        const int index = file.accessor<std::uint32_t>({0, 1, 2}, 5125, "SCALAR", 1);
        file.root["meshes"][0]["primitives"][0]["indices"] = index;
        change(file);
        EXPECT_EQ(load_error(file.write(folder)).code(), Errc::bad_input) << what;
    };
    rejects("count", [](GltfFile& f) { f.root["accessors"][0]["count"] = 4; });
    rejects("huge count", [](GltfFile& f) { f.root["accessors"][0]["count"] = 1e15; });
    rejects("negative count", [](GltfFile& f) { f.root["accessors"][0]["count"] = -1; });
    rejects("offset", [](GltfFile& f) { f.root["accessors"][0]["byteOffset"] = 4; });
    rejects("huge offset", [](GltfFile& f) { f.root["bufferViews"][0]["byteOffset"] = 9e15; });
    rejects("view", [](GltfFile& f) { f.root["accessors"][0]["bufferView"] = 7; });
    rejects("stride", [](GltfFile& f) { f.root["bufferViews"][0]["byteStride"] = 1; });
    rejects("zeros without end", [](GltfFile& f) {
        f.root["accessors"][0].erase("bufferView");
        f.root["accessors"][0]["count"] = 1e12;
    });
    rejects("index", [](GltfFile& f) { f.data[f.data.size() - 1] = 1; });
    rejects("a node above itself", [](GltfFile& f) { f.root["nodes"][0]["children"] = {0}; });
    rejects("material", [](GltfFile& f) { f.root["meshes"][0]["primitives"][0]["material"] = 0; });
    rejects("wrong JSON type", [](GltfFile& f) { f.root["nodes"] = "none"; });
    rejects("component type", [](GltfFile& f) { f.root["accessors"][0]["componentType"] = 5124; });
}

TEST(Gltf, RejectsNodesThatMultiplyThemselves) {
    const TemporaryFolder folder;
    GltfFile file = with_triangle();  // 2^64 triangles, if each node were walked once per parent
    file.root["nodes"] = json::array();
    for (int i = 0; i < 64; ++i) file.root["nodes"].push_back({{"children", {i + 1, i + 1}}});
    file.root["nodes"].push_back({{"mesh", 0}});
    EXPECT_EQ(load_error(file.write(folder)).code(), Errc::bad_input);
}

TEST(Gltf, SurvivesJsonOfAnyDepth) {
    const TemporaryFolder folder;
    const std::string deep = R"({"extras":)" + std::string(1'000'000, '[');
    EXPECT_EQ(load_error(folder.write("a.gltf", deep)).code(), Errc::bad_input);
    EXPECT_EQ(load_error(folder.write("b.gltf", deep + std::string(1'000'000, ']') + "}")).code(),
              Errc::bad_input);
}

TEST(Gltf, SaysWhichOtherVersionItIs) {
    const TemporaryFolder folder;
    GltfFile file = with_triangle();
    const auto says = [](const std::filesystem::path& written, const std::string& version) {
        const Error error = load_error(written);
        EXPECT_EQ(error.code(), Errc::unsupported);
        EXPECT_NE(std::string(error.what()).find("glTF " + version), std::string::npos)
            << error.what();
    };
    file.root["asset"]["version"] = "1.0";
    says(file.write(folder), "1.0");
    says(folder.write("a.glb", "glTF" + raw(1u) + std::string(20, '\0')), "1");
    for (const char* version : {"2", "2.1"}) {
        file.root["asset"]["version"] = version;
        EXPECT_EQ(load_scene(file.write(folder)).triangles.size(), 1u);
    }
}

TEST(Gltf, SaysThatPointsAndLinesAreNoTriangles) {
    const TemporaryFolder folder;
    GltfFile file = with_triangle();
    for (const int mode : {0, 1, 2, 3}) {
        file.root["meshes"][0]["primitives"][0]["mode"] = mode;
        const Error error = load_error(file.write(folder));
        EXPECT_EQ(error.code(), Errc::bad_input);
        EXPECT_NE(std::string(error.what()).find("only points or lines"), std::string::npos);
    }
}

TEST(Gltf, NamesABufferThatDoesNotExist) {
    const TemporaryFolder folder;
    GltfFile file = with_triangle();
    const auto written = file.write(folder);
    std::filesystem::remove(folder / "my data.bin");
    const Error error = load_error(written);
    EXPECT_EQ(error.code(), Errc::bad_input);
    EXPECT_EQ(error.file(), written);
    EXPECT_NE(std::string(error.what()).find("my%20data.bin"), std::string::npos);
}

TEST(Gltf, GlbEndsInAnErrorWhereverItIsCutShort) {
    const TemporaryFolder folder;
    GltfFile file = with_triangle();
    file.root["buffers"] = {{{"byteLength", file.data.size()}}};
    std::string text = file.root.dump();
    while (text.size() % 4 != 0) text += ' ';
    const auto word = [](std::size_t value) { return raw(static_cast<std::uint32_t>(value)); };
    const std::string bytes = "glTF" + word(2) + word(28 + text.size() + file.data.size()) +
                              word(text.size()) + "JSON" + text + word(file.data.size()) +
                              std::string("BIN\0", 4) + file.data;
    EXPECT_EQ(load_scene(folder.write("a.glb", bytes)).triangles.size(), 1u);
    for (std::size_t size = 0; size < bytes.size(); ++size)
        EXPECT_EQ(load_error(folder.write("a.glb", bytes.substr(0, size))).code(), Errc::bad_input)
            << "cut at " << size;
}

}  // namespace
}  // namespace octavo
