// SPDX-License-Identifier: MIT
#include "octavo/mesh/mesh_lamps.h"

#include <gtest/gtest.h>

#include <cmath>

namespace octavo {
namespace {

double area(const Light& lamp) {
    double sum = 0.0;
    for (const auto& t : lamp.triangles)
        sum += 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
    return sum;
}

/// Triangles of growing size, of these materials in turn.
Scene triangles(std::size_t count, std::vector<Material> materials) {
    Scene scene;
    scene.materials = std::move(materials);
    for (std::size_t i = 0; i < count; ++i) {
        const auto first = static_cast<std::uint32_t>(scene.positions.size());
        const dvec3 at(static_cast<double>(i), 0, 0);
        for (const dvec3& p : {at, at + dvec3(0, 1.0 + static_cast<double>(i), 0), at + dvec3(1)})
            scene.positions.push_back(p);
        scene.triangles.emplace_back(first, first + 1, first + 2);
        scene.triangle_materials.push_back(static_cast<std::uint32_t>(i % scene.materials.size()));
    }
    return scene;
}

Material shining(const vec3& emission) {
    Material material;
    material.name = "lamp";
    material.emission = emission;
    return material;
}

TEST(MeshLamps, AreTheTrianglesOfMaterialsThatShine) {
    Material textured = shining(vec3(1.0f));
    textured.emission_texture = 0;
    Scene scene = triangles(40, {shining({1, 2, 3}), Material{}, textured, shining({0, 0, 5})});
    scene.triangles[4].z = scene.triangles[4].y;  // no area
    scene.positions[scene.triangles[8].x].x = std::nan("");
    scene.triangle_materials[12] = Scene::kNoMaterial;
    const std::vector<Light> lamps = mesh_lamps(scene);
    ASSERT_EQ(lamps.size(), 2u);
    EXPECT_EQ(lamps[0].kind, Light::Kind::mesh);
    EXPECT_EQ(lamps[0].name, "lamp");
    EXPECT_EQ(lamps[0].intensity, vec3(1, 2, 3));
    EXPECT_EQ(lamps[0].triangles.size(), 7u);
    EXPECT_EQ(lamps[1].triangles.size(), 10u);
    EXPECT_EQ(lamps[1].triangles[1], scene.corners(7));
}

TEST(MeshLamps, GiveTheSameLightWithFewerTriangles) {
    const Scene scene = triangles(300, {shining(vec3(1.0f)), shining(vec3(2.0f))});
    const std::vector<Light> all = mesh_lamps(scene);
    const std::vector<Light> some = mesh_lamps(scene, 20);
    ASSERT_EQ(some.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(some[i].triangles.size(), 10u);
        EXPECT_NEAR(some[i].intensity.x * area(some[i]), all[i].intensity.x * area(all[i]),
                    1e-5 * area(all[i]));
    }
}

TEST(MeshLamps, AreNoneInASceneWithoutMaterials) {
    Scene scene = triangles(3, {shining(vec3(1.0f))});
    scene.materials.clear();
    scene.triangle_materials.clear();
    EXPECT_TRUE(mesh_lamps(scene).empty());
}

}  // namespace
}  // namespace octavo
