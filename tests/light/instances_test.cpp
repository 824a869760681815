// SPDX-License-Identifier: MIT
#include "octavo/trace/instances.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "light/voxel_rooms.h"
#include "octavo/core/error.h"
#include "octavo/light/light_cells.h"
#include "octavo/light/side_light.h"
#include "octavo/trace/wide.h"
#include "support/small_dags.h"

namespace octavo {
namespace {

using test::grey;
using test::unit_grid;

std::vector<shared::GridRay> random_rays(int count, double side, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-0.2 * side, 1.2 * side), way(-1.0, 1.0);
    std::vector<shared::GridRay> rays;
    for (int i = 0; i < count; ++i)
        rays.push_back(grid_ray({place(random), place(random), place(random)},
                                vec3(way(random), way(random), way(random)), 1e30f));
    return rays;
}

TEST(Instances, OneInPlaceGivesTheBitsOfItsDag) {
    const Dag dag = test::dust(5, 0.3, 3);
    const Instances one({{dag, unit_grid(5)}});
    const auto rays = random_rays(500, 32.0, 1);
    std::vector<InstanceHit> hits(rays.size());
    std::vector<shared::GridHit> expected(rays.size());
    one.trace_closest(rays, {0, 0.0f, 0.0f}, hits);
    trace_closest_wide(dag, rays, {0, 0.0f, 0.0f}, expected);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        EXPECT_EQ(hits[i].hit.face, expected[i].face);
        EXPECT_EQ(hits[i].hit.path, expected[i].path);
        EXPECT_EQ(hits[i].hit.t, expected[i].t);
    }
}

// Twelve copies of one DAG, turned by right angles and apart: the voxels of each are known.
TEST(Instances, ManyMovedOnesAreHitWhereTheNearestOfThemIs) {
    const Dag dag = test::dust(4, 0.4, 5);
    std::vector<Instance> objects;
    for (int i = 0; i < 12; ++i) {
        const ivec2 place(i % 4, i / 4);
        dmat4 m = glm::translate(dmat4(1.0), dvec3(20.0 * place.x, 20.0 * place.y, 7.0 * i));
        m = glm::rotate(m, 0.7 * i, glm::normalize(dvec3(1, i, 2)));
        m = glm::scale(m, dvec3(1.0 + 0.1 * i));
        objects.push_back({dag, unit_grid(4), i == 0 ? dmat4(1.0) : m});
    }
    const Instances all(objects);
    const auto rays = random_rays(2000, 80.0, 2);
    std::vector<InstanceHit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size());
    all.trace_closest(rays, {0, 0.0f, 0.0f}, hits);
    all.trace_any(rays, {0, 0.0f, 0.0f}, occluded);
    int found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        // Each object alone, by the plain text, in double from world space.
        float nearest = 1e30f;
        for (const Instance& object : objects) {
            const dmat4 inverse = glm::inverse(object.placement);
            const dvec3 from(inverse * dvec4(origin_of(rays[i]), 1.0));
            const vec3 way(glm::dmat3(inverse) * dvec3(rays[i].dir));
            const auto hit = shared::trace_closest(shared::view(object.dag),
                                                   grid_ray(from, way, 1e30f), {0, 0.0f, 0.0f});
            if (hit.face != shared::kFaceNone) nearest = std::min(nearest, hit.t);
        }
        ASSERT_EQ(static_cast<bool>(hits[i]), nearest < 1e30f) << i;
        ASSERT_EQ(occluded[i] != 0, nearest < 1e30f) << i;
        if (!hits[i]) continue;
        ++found;
        EXPECT_NEAR(hits[i].hit.t, nearest, 1e-4f * (1.0f + nearest)) << i;
    }
    EXPECT_GT(found, 200);
}

// Rays to a sun behind a moved wall, which stands in the scene twice: its tables answer.
TEST(Instances, WallsThatHaveMovedAnswerWithTheBitsOfOneRayAtATime) {
    const Dag wall = test::slanted_wall(9, {1, 17, 2}, 10 << 9);
    std::vector<Instance> objects{{test::dust(5, 0.2, 3), unit_grid(5)}};
    for (const double x : {40.0, 600.0}) {
        dmat4 m = glm::translate(dmat4(1.0), dvec3(x, 30.0, 10.0));
        m = glm::rotate(m, 0.4, glm::normalize(dvec3(1, 2, 3)));
        objects.push_back({wall, unit_grid(9), glm::scale(m, dvec3(1.1))});
    }
    const Instances tables(objects), alone(objects, WideWalk::one_by_one);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(200.0, 300.0);
    std::vector<shared::GridRay> rays;
    for (int group = 0; group < 500; ++group) {
        const dvec3 from(place(random), 700.0, place(random));
        for (int i = 0; i < 64; ++i)
            rays.push_back(grid_ray(from + dvec3(i % 8, 0.0, i / 8), {0.2f, -1.0f, 0.1f}, 1e30f));
    }
    std::vector<std::uint8_t> found(rays.size()), expected(rays.size());
    for (int i = 0; i < 5; ++i) tables.trace_any(rays, {0, 0.0f, 0.0f}, found);
    alone.trace_any(rays, {0, 0.0f, 0.0f}, expected);
    EXPECT_EQ(found, expected);
    EXPECT_GT(tables.partitions(1)->earned(), 2000u);
    EXPECT_EQ(tables.partitions(1), tables.partitions(2));
    EXPECT_NE(tables.partitions(0), tables.partitions(1));
    EXPECT_EQ(alone.partitions(1), nullptr);
}

TEST(Instances, RefusesPlacementsWithoutAnInverse) {
    const Dag dag = test::dust(4, 0.4, 5);
    EXPECT_THROW(Instances({}), Error);
    EXPECT_THROW(Instances({{dag, unit_grid(4), dmat4(0.0)}}), Error);
    dmat4 flat(1.0);
    flat[1][1] = 0.0;
    EXPECT_THROW(Instances({{dag, unit_grid(4), flat}}), Error);
}

/// A floor, and above it a plate that may move.
class FloorAndPlate : public testing::Test {
protected:
    FloorAndPlate() {
        const Dag floor = test::dag_of_voxels(6, [](const dvec3& p) { return p.y < 3.0; });
        const Dag plate = test::dag_of_voxels(4, [](const dvec3& p) { return p.y < 1.0; });
        scene.objects.push_back(
            {.dag = floor, .grid = unit_grid(6), .attributes = grey(floor, 6, 200)});
        scene.objects.push_back({.dag = plate,
                                 .grid = unit_grid(4),
                                 .attributes = grey(plate, 4, 200),
                                 .placement = glm::translate(dmat4(1.0), dvec3(24, 12, 24))});
        scene.lights.push_back(sun_at(0.0, 1.5707));
        scene.lights[0].size = 0.0;
    }
    [[nodiscard]] float floor_at(const dvec3& point, Lighting lighting) const {
        RenderOptions options = test::small_picture(point + dvec3(0.0, 5.0, 2.0), point, 4);
        options.ao_samples = 32;
        const Image image = render_lit(scene, lighting, options);
        return image.color[image.index(16, 12)].g;
    }
    LitScene scene;
};

TEST_F(FloorAndPlate, ShadowsAndLightCrossBothWays) {
    light_cells(scene, {.around_rays = 16});
    for (const Lighting l : {Lighting::gathered, Lighting::cached, Lighting::reference}) {
        EXPECT_LT(floor_at({32, 3, 32}, l), 0.3f * floor_at({8, 3, 8}, l)) << static_cast<int>(l);
    }
    // The plate's lower side gets light that the floor sends back, from the sun alone.
    const auto& plate = scene.objects[1];
    const auto edge = plate.attributes.cells().find({0, 0, 8});
    EXPECT_GT(plate.light.get(*edge, 2).g, 0.02f);
}

TEST_F(FloorAndPlate, AMovedObjectTakesItsShadowsAlong) {
    scene.sky = Sky::constant(vec3(0.2f));
    const dmat4 place = glm::translate(dmat4(1.0), dvec3(4, 12, 4));
    CellLighter lighter(scene, {.around_rays = 32});
    lighter.light_all();
    std::vector<float> shaded, open;
    for (const Lighting l : {Lighting::gathered, Lighting::cached}) {
        shaded.push_back(floor_at({32, 3, 32}, l));
        open.push_back(floor_at({12, 3, 12}, l));
    }
    lighter.move_object(1, place);
    for (const Lighting l : {Lighting::gathered, Lighting::cached}) {
        const auto i = static_cast<std::size_t>(l);
        EXPECT_GT(floor_at({32, 3, 32}, l), 2.0f * shaded[i]);
        EXPECT_LT(floor_at({12, 3, 12}, l), 0.5f * open[i]);
    }

    LitScene again = scene;
    light_cells(again, {.around_rays = 32});
    for (std::size_t o = 0; o < 2; ++o) {
        const CellLight& found = scene.objects[o].light;
        const CellLight& expected = again.objects[o].light;
        ASSERT_EQ(found.words().size(), expected.words().size());
        float worst = 0.0f;
        double difference = 0.0, all = 0.0;
        for (std::uint64_t cell = 0; cell < found.count(); ++cell)
            for (int d = 0; d < 6; ++d) {
                ASSERT_EQ(found.hidden(cell, d), expected.hidden(cell, d));
                const float change = std::abs(found.get(cell, d).g - expected.get(cell, d).g);
                worst = std::max(worst, change);
                difference += static_cast<double>(change);
                all += static_cast<double>(expected.get(cell, d).g);
            }
        EXPECT_LT(worst, 0.05f);
        EXPECT_LT(difference, 0.001 * all);
    }
    EXPECT_THROW(lighter.move_object(0, dmat4(1.0)), Error);
    EXPECT_THROW(lighter.move_object(1, dmat4(0.0)), Error);
}

TEST(MovedObject, CostsWhatItReachesAndNotTheScene) {
    const Dag floor = test::dag_of_voxels(8, [](const dvec3& p) { return p.y < 3.0; });
    const Dag plate = test::dag_of_voxels(3, [](const dvec3& p) { return p.y < 1.0; });
    LitScene scene;
    scene.objects.push_back(
        {.dag = floor, .grid = unit_grid(8), .attributes = grey(floor, 8, 100)});
    scene.objects.push_back({.dag = plate,
                             .grid = unit_grid(3),
                             .attributes = grey(plate, 3, 100),
                             .placement = glm::translate(dmat4(1.0), dvec3(20, 8, 20))});
    scene.lights.push_back(sun_at(0.5, 1.0));
    scene.sky = Sky::constant(vec3(0.2f));
    CellLighter lighter(scene, {.around_rays = 4});
    const LightReport all = lighter.light_all();
    const LightReport moved = lighter.move_object(1, glm::translate(dmat4(1.0), dvec3(24, 8, 20)));
    EXPECT_LT(moved.rays, all.rays / 10);
    EXPECT_GT(moved.rays, 0u);
}

/// A floor below cells that shine; a plate, and dust without attributes, which move.
LitScene moving_things(bool lamp) {
    const Dag floor = test::dag_of_voxels(
        6, [&](const dvec3& p) { return p.y < 3.0 || (lamp && p.y > 60.0 && p.x < 20.0); });
    const Dag plate = test::dag_of_voxels(4, [](const dvec3& p) { return p.y < 1.0; });
    LitScene scene;
    scene.objects.push_back(
        {.dag = floor, .grid = unit_grid(6), .attributes = grey(floor, 5, 200, [](const uvec3& at) {
                                                 return at.y > 20 ? 2.0f : 0.0f;
                                             })});
    scene.objects.push_back({.dag = plate, .grid = unit_grid(4), .attributes = grey(plate, 4, 90)});
    scene.objects.push_back({.dag = test::dust(4, 0.4, 5), .grid = unit_grid(4)});
    scene.objects[1].placement = glm::translate(dmat4(1.0), dvec3(24, 12, 24));
    scene.objects[2].placement = glm::translate(dmat4(1.0), dvec3(40, 4.5, 30));
    scene.sky = Sky::clear({0, 1, 0});
    return scene;
}

TEST(MovedObject, WhatItsMoveLeavesOfTheRaysIsWhatTracingAllOfThemFinds) {
    const std::vector<std::pair<std::size_t, dmat4>> moves = {
        {1, glm::translate(dmat4(1.0), dvec3(26, 12, 22))},
        {2, glm::scale(glm::translate(dmat4(1.0), dvec3(20, 3.7, 8)), dvec3(0.9))},
        {1, glm::rotate(glm::translate(dmat4(1.0), dvec3(40, 5, 40)), 0.7, dvec3(0.6, 0.0, 0.8))},
        {2, glm::translate(dmat4(1.0), dvec3(33, 2.1, 42))},
        {1, glm::translate(dmat4(1.0), dvec3(60, 40, 10))},
        {1, glm::translate(dmat4(1.0), dvec3(24, 3.0, 24))}};
    for (const bool lamp : {false, true}) {
        LitScene scene = moving_things(lamp);
        // Rays towards cells that shine are all traced: few of them, so that the others show.
        const LightOptions options{.bounces = 0, .around_rays = 32, .source_rays = 16};
        SideLight kept(scene, options), traced(scene, options);
        const auto look_around = [&](SideLight& light, const MovedObject* moved) {
            light.start_counting();
            ObjectLight& floor = light.objects()[0];
            for (const SideBlock& block : floor.blocks) {
                if (moved) {
                    light.gather_around(floor, block, *moved);
                } else {
                    light.gather_around(floor, block);
                }
            }
            return light.rays();
        };
        look_around(kept, nullptr);
        for (const auto& [which, placement] : moves) {
            ObjectLight& object = kept.objects()[which];
            MovedObject moved{static_cast<std::uint32_t>(which),
                              box_with_margin(scene, kept.world(), object),
                              {}};
            scene.objects[which].placement = placement;
            kept.renew_world();
            traced.renew_world();
            place_blocks(scene, kept.world(), object);
            moved.after = box_with_margin(scene, kept.world(), object);
            const std::uint64_t few = look_around(kept, &moved);
            EXPECT_LT(few, look_around(traced, nullptr) / 2) << lamp;
            EXPECT_EQ(kept.objects()[0].rows, traced.objects()[0].rows);
            EXPECT_EQ(kept.objects()[0].from_sources, traced.objects()[0].from_sources);
        }
    }
}

}  // namespace
}  // namespace octavo
