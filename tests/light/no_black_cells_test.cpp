// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <string>

#include "octavo/attributes/build_attributes.h"
#include "octavo/construct/build.h"
#include "octavo/light/light_cells.h"
#include "octavo/mesh/decode_textures.h"
#include "octavo/mesh/load.h"
#include "octavo/mesh/samples.h"
#include "octavo/trace/trace.h"
#include "support/shared_scenes.h"

namespace octavo {
namespace {

struct Found {
    std::uint64_t hits = 0;
    std::uint64_t without_path = 0;   // cells that have no colour by their path
    std::uint64_t without_point = 0;  // and by the point that was hit
    std::uint64_t hidden = 0;         // sides that were hit, and are said not to be seen
    std::uint64_t along_edges = 0;    // of faces that are not open
};

/// Rays from outside and inside of a scene's box to places in it.
Found look_everywhere(Scene scene, int depth, int level, int rays) {
    decode_textures(scene, WantedTextures::all);
    BuildOptions options;
    options.depth = depth;
    const BuildResult built = build(scene, options);
    const Attributes attributes =
        build_attributes(scene, built.dag, built.grid, {.emission = false, .level = level});
    LitScene lit;
    lit.objects.push_back({.dag = built.dag, .grid = built.grid, .attributes = attributes});
    light_cells(lit, {.bounces = 0, .around_rays = 1, .kept_bytes = 0});

    const Box box = scene.bounds();
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto place = [&] { return dvec3(unit(random), unit(random), unit(random)); };
    Found found;
    for (int i = 0; i < rays; ++i) {
        const dvec3 to = box.low + box.size() * place();
        dvec3 from = box.low + box.size() * place();
        if (i % 2 == 0) from = box.centre() + 3.0 * (from - box.centre());
        const Ray ray{.origin = from, .direction = to - from};
        const Hit hit = trace_closest(built.dag, built.grid, ray);
        if (!hit || hit.face == Face::inside) continue;
        ++found.hits;
        const vec3 towards(-ray.direction);
        if (!attributes.color(hit.path, hit.level, towards)) ++found.without_path;
        const dvec3 point = built.grid.to_grid(from + hit.t * ray.direction);
        if (!attributes.color(point, towards)) ++found.without_point;
        const auto cell = attributes.cells().find(hit.path >> static_cast<unsigned>(depth - level));
        // The voxel before the face is open, so the face can be seen; but for a ray that comes in
        // exactly along an edge, between two voxels.
        const ivec3 before = ivec3(hit.path) + ivec3(hit.normal());
        const bool open = glm::any(glm::lessThan(before, ivec3(0))) ||
                          glm::any(glm::greaterThanEqual(before, ivec3(1 << depth))) ||
                          !built.dag.voxel(uvec3(before));
        if (!open) ++found.along_edges;
        if (cell && depth == level && open &&
            lit.objects[0].light.hidden(*cell, static_cast<int>(hit.face)))
            ++found.hidden;
    }
    return found;
}

void expect_all_found(const Found& found, const std::string& name) {
    EXPECT_GT(found.hits, 1000u) << name;
    EXPECT_EQ(found.without_path, 0u) << name << ", of " << found.hits;
    EXPECT_EQ(found.without_point, 0u) << name << ", of " << found.hits;
    EXPECT_EQ(found.hidden, 0u) << name << ", of " << found.hits;
    EXPECT_LE(found.along_edges, found.hits / 10'000) << name;
}

TEST(NoBlackCells, EveryHitInASampleFindsItsColor) {
    for (const SampleInfo& sample : samples())
        for (const int level : {5, 7})
            expect_all_found(look_everywhere(make_sample(sample.name, 0.02), 7, level, 10'000),
                             std::string(sample.name));
}

class NoBlackCellsSlow : public testing::TestWithParam<const char*> {};

TEST_P(NoBlackCellsSlow, EveryHitInARealSceneFindsItsColor) {
    OCTAVO_REQUIRE_SCENE(GetParam());
    const Scene scene = load_scene(test::shared_scenes() / GetParam());
    for (const int level : {7, 9})
        expect_all_found(look_everywhere(scene, 9, level, 50'000), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Scenes, NoBlackCellsSlow,
                         testing::Values("sponza/Sponza.gltf", "bathroom2/bathroom2.gltf",
                                         "bunny/bun_zipper.ply", "dragon/dragon_vrip_res3.ply.gz",
                                         "terrain/2598528.obj"));

}  // namespace
}  // namespace octavo
