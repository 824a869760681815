// SPDX-License-Identifier: MIT
#include "octavo/mesh/save.h"

#include <gtest/gtest.h>

#include "mesh/mesh_files.h"
#include "octavo/mesh/samples.h"

namespace octavo {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

Scene colorful_scene(const dvec3& origin) {
    Scene scene;
    scene.positions = {origin, origin + dvec3(1, 0, 0), origin + dvec3(0, 1, 0.001),
                       origin + dvec3(0, 0, 1)};
    scene.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 2, 3}};
    scene.colors = {{1, 2, 3, 255}, {100, 101, 102, 255}, {254, 255, 0, 255}, {9, 99, 199, 255}};
    scene.texture_coordinates = {{0, 0}, {1, 0.25f}, {0.5f, 1}, {0.125f, 2}};
    scene.materials.resize(2);
    scene.materials[0].name = "wall";
    scene.materials[0].base_color = {0.25f, 0.5f, 0.75f, 1.0f};
    scene.materials[0].base_color_texture = 0;
    scene.materials[0].alpha_cutoff = 0.5f;
    scene.materials[1].name = "lamp";
    scene.materials[1].emission = {16.0f, 8.0f, 4.0f};
    scene.triangle_materials = {0, 1, 0};
    return scene;
}

/// The triangles of a scene as corner positions, in the order of `scene`.
std::vector<std::array<dvec3, 3>> all_corners(const Scene& scene) {
    std::vector<std::array<dvec3, 3>> corners;
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) corners.push_back(scene.corners(i));
    return corners;
}

TEST(Save, ObjRoundTripIsExactInDouble) {
    const TemporaryFolder folder;
    Scene scene = colorful_scene({5734567.123456789, 4321987.25, 1.0 / 3.0});
    scene.textures.push_back({"t", folder.write("sub/my wall.png", "png"), {}});
    save_scene(scene, folder.path() / "a.obj");
    const Scene back = load_scene(folder.path() / "a.obj");
    EXPECT_EQ(all_corners(back), all_corners(scene));
    EXPECT_EQ(back.colors, scene.colors);
    EXPECT_EQ(back.texture_coordinates, scene.texture_coordinates);
    ASSERT_EQ(back.textures.size(), 1u);
    EXPECT_EQ(back.textures[0].file, scene.textures[0].file);
    EXPECT_EQ(back.materials[0].base_color, scene.materials[0].base_color);
    EXPECT_TRUE(back.materials[0].alpha_cutoff);
    EXPECT_EQ(back.materials[1].emission, scene.materials[1].emission);
    EXPECT_EQ(back.triangle_materials, scene.triangle_materials);
}

TEST(Save, ObjHasPicturesThatAreNotInItsFolderBesideIt) {
    const TemporaryFolder elsewhere, folder;
    Scene scene = colorful_scene({0, 0, 0});
    scene.textures.push_back({"t", elsewhere.write("wall.png", "\x89PNG outside"), {}});
    scene.textures.push_back({.name = "inside a scene file", .file = {}, .encoded = {}});
    for (const char c : {'\xff', '\xd8', 'j'})
        scene.textures.back().encoded.push_back(static_cast<std::byte>(c));
    scene.materials[1].emission_texture = 1;
    save_scene(scene, folder.path() / "a.obj");
    const Scene back = load_scene(folder.path() / "a.obj");
    ASSERT_EQ(back.textures.size(), 2u);
    EXPECT_EQ(back.textures[0].file, folder.path() / "a-0.png");
    EXPECT_EQ(back.textures[1].file, folder.path() / "a-1.jpg");
    EXPECT_EQ(fs::file_size(folder.path() / "a-0.png"), 12u);
    EXPECT_EQ(fs::file_size(folder.path() / "a-1.jpg"), 3u);
}

TEST(Save, PlyRoundTripIsExactInFloatAndInDouble) {
    const TemporaryFolder folder;
    for (const dvec3 origin : {dvec3(0.5, 0, 0), dvec3(5734567.123456789, 4321987.25, 1.0 / 3.0)}) {
        Scene scene = colorful_scene(origin);
        if (origin.x == 0.5) scene.positions[2] = {0.25, 1, 0};
        save_scene(scene, folder.path() / "a.ply");
        const Scene back = load_scene(folder.path() / "a.ply");
        EXPECT_EQ(back.positions, scene.positions);
        EXPECT_EQ(back.triangles, scene.triangles);
        EXPECT_EQ(back.colors, scene.colors);
    }
    // Floats where they suffice: three times four bytes, four colours, and 13 for each triangle.
    const Scene sample = make_sample("courtyard", 0.01);
    save_scene(sample, folder.path() / "b.ply");
    EXPECT_LT(fs::file_size(folder.path() / "b.ply"),
              16 * sample.positions.size() + 13 * sample.triangles.size() + 400);
}

TEST(Save, GlbRoundTripKeepsEverything) {
    const TemporaryFolder folder;
    Scene scene = colorful_scene({0, 0, 0});
    scene.positions[2] = {0, 1, 0.5};
    scene.textures.push_back({"t", {}, {std::byte{0x89}, std::byte{'P'}, std::byte{'N'}}});
    Camera camera;
    camera.name = "view";
    camera.eye = {1, 2, 3};
    camera.forward = glm::normalize(dvec3(1, -1, 2));
    camera.up =
        glm::normalize(glm::cross(glm::cross(camera.forward, dvec3(0, 1, 0)), camera.forward));
    camera.vertical_fov = 0.7;
    scene.cameras.push_back(camera);
    Light sun, spot;
    sun.name = "sun";
    sun.direction = {0, -1, 0};
    sun.intensity = {3, 2, 1};
    spot.kind = Light::Kind::spot;
    spot.position = {7, 8, 9};
    spot.direction = {1, 0, 0};
    spot.inner_angle = 0.25;
    spot.outer_angle = 0.5;
    scene.lights = {sun, spot};
    save_scene(scene, folder.path() / "a.glb");

    const Scene back = load_scene(folder.path() / "a.glb");
    EXPECT_EQ(back.positions, scene.positions);
    EXPECT_EQ(back.colors, scene.colors);
    EXPECT_EQ(back.texture_coordinates, scene.texture_coordinates);
    // Triangles are grouped by material.
    EXPECT_EQ(back.triangles, (std::vector<uvec3>{{0, 1, 2}, {1, 2, 3}, {0, 2, 3}}));
    EXPECT_EQ(back.triangle_materials, (std::vector<std::uint32_t>{0, 0, 1}));
    EXPECT_EQ(back.textures[0].encoded, scene.textures[0].encoded);
    EXPECT_EQ(back.materials[0].base_color, scene.materials[0].base_color);
    EXPECT_EQ(back.materials[0].alpha_cutoff, 0.5f);
    EXPECT_EQ(back.materials[1].emission, scene.materials[1].emission);

    ASSERT_EQ(back.cameras.size(), 1u);
    EXPECT_EQ(back.cameras[0].name, "view");
    EXPECT_EQ(back.cameras[0].eye, camera.eye);
    EXPECT_NEAR(glm::distance(back.cameras[0].forward, camera.forward), 0, 1e-12);
    EXPECT_NEAR(glm::distance(back.cameras[0].up, camera.up), 0, 1e-12);
    EXPECT_EQ(back.cameras[0].vertical_fov, 0.7);
    ASSERT_EQ(back.lights.size(), 2u);
    EXPECT_EQ(back.lights[0].kind, Light::Kind::sun);
    EXPECT_NEAR(glm::distance(back.lights[0].direction, sun.direction), 0, 1e-12);
    EXPECT_NEAR(glm::distance(back.lights[0].intensity, sun.intensity), 0, 1e-6);
    EXPECT_EQ(back.lights[1].position, spot.position);
    EXPECT_EQ(back.lights[1].outer_angle, 0.5);
}

TEST(Save, GlbKeepsTheDetailOfASceneFarFromTheOrigin) {
    const TemporaryFolder folder;
    const Scene scene = colorful_scene({5734567.125, 4321987.25, 812.5});
    Scene plain = scene;
    plain.materials[0].base_color_texture = Material::kNoTexture;
    save_scene(plain, folder.path() / "a.glb");
    const Scene back = load_scene(folder.path() / "a.glb");
    for (std::size_t i = 0; i < scene.positions.size(); ++i)
        EXPECT_LT(glm::distance(back.positions[i], scene.positions[i]), 1e-7);
}

TEST(Save, SamplesSurviveEveryFormat) {
    const TemporaryFolder folder;
    for (const SampleInfo& info : samples()) {
        const Scene scene = make_sample(info.name, 0.01);
        for (const char* extension : {"glb", "obj", "ply"}) {
            const fs::path file = folder.path() / (std::string(info.name) + "." + extension);
            save_scene(scene, file);
            const Scene back = load_scene(file);
            EXPECT_EQ(back.positions, scene.positions) << file;
            EXPECT_EQ(back.triangles.size(), scene.triangles.size()) << file;
            EXPECT_TRUE(back.warnings.empty()) << file << ": " << back.warnings[0];
        }
    }
}

TEST(Save, LeavesTheOldFileWholeWhereItFails) {
    const TemporaryFolder folder;
    const auto file = folder.write("a.ply", "old");
    const auto glb = folder.write("a.glb", "old");
    Scene scene = colorful_scene({0, 0, 0});
    scene.textures.push_back({"t", folder.path() / "gone.png", {}});
    EXPECT_THROW(save_scene(scene, glb), Error);
    EXPECT_EQ(fs::file_size(glb), 3u);
    EXPECT_THROW(save_scene(scene, folder.path() / "no/such/folder.ply"), Error);
    EXPECT_THROW(save_scene(scene, folder.path() / "a.xyz"), Error);
    save_scene(scene, file);
    EXPECT_GT(fs::file_size(file), 3u);
    for (const auto& entry : fs::directory_iterator(folder.path()))
        EXPECT_EQ(entry.path().string().find(".part"), std::string::npos) << entry.path();
}

}  // namespace
}  // namespace octavo
