// SPDX-License-Identifier: MIT
//
// How right the light is: docs/lighting.md has these numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "light/voxel_rooms.h"
#include "octavo/attributes/build_attributes.h"
#include "octavo/construct/build.h"
#include "octavo/light/light_cells.h"
#include "octavo/mesh/samples.h"
#include "octavo/render/render_lit.h"
#include "support/lamps.h"

namespace octavo {
namespace {

using test::greatest_channel;
using test::grey;
using test::mean_green;
using test::small_picture;
using test::unit_grid;

LitScene scene_of(const Dag& dag, Attributes attributes, const Sky& sky) {
    LitScene scene;
    scene.objects.push_back(
        {.dag = dag, .grid = unit_grid(dag.depth()), .attributes = std::move(attributes)});
    scene.sky = sky;
    return scene;
}

Light bright_sun() {
    Light sun = sun_at(0.7, 0.9);
    sun.intensity = vec3(100.0f);
    return sun;
}

/// Pictures from the middle of the grid in four directions.
float brightest_inside(const LitScene& scene, Lighting lighting, int samples) {
    const double middle = 0.5 * std::ldexp(1.0, scene.objects[0].grid.depth);
    float most = 0.0f;
    for (const dvec3& way : {dvec3(1, 0, 0.3), dvec3(-1, 0.6, -0.4), dvec3(0.2, -0.7, 1)}) {
        RenderOptions options = small_picture(dvec3(middle), dvec3(middle) + way, samples);
        options.ao_samples = 16;
        most = std::max(most, greatest_channel(render_lit(scene, lighting, options)));
    }
    return most;
}

TEST(SealedBoxSlow, NoLightComesThroughWallsOfOneTwoAndFourVoxels) {
    for (const double degrees : {0.0, 17.0, 45.0})
        for (const double thick : {1.0, 2.0, 4.0}) {
            SCOPED_TRACE(std::to_string(degrees) + " degrees, " + std::to_string(thick));
            const Dag dag = test::sealed_box(6, 18.3, degrees, thick);
            LitScene scene = scene_of(dag, grey(dag, 6, 230), Sky::constant(vec3(50.0f)));
            scene.lights.push_back(bright_sun());
            light_cells(scene, {.around_rays = 16});
            EXPECT_EQ(brightest_inside(scene, Lighting::gathered, 4), 0.0f);
            EXPECT_EQ(brightest_inside(scene, Lighting::reference, 4), 0.0f);
            const float cached = brightest_inside(scene, Lighting::cached, 1);
            RecordProperty("cached", std::to_string(cached));
            EXPECT_EQ(cached, 0.0f);
        }
}

TEST(SealedBoxSlow, NoLightComesThroughWallsOfOneVoxelAtAnyAngle) {
    for (int i = 0; i < 45; ++i) {
        const double degrees = 2.0 * i;
        const double half = 8.0 + 0.066 * i;
        SCOPED_TRACE(std::to_string(degrees) + " degrees, half of " + std::to_string(half));
        const Dag dag = test::sealed_box(5, half, degrees, 1.0);
        LitScene scene = scene_of(dag, grey(dag, 5, 230), Sky::constant(vec3(50.0f)));
        scene.lights.push_back(bright_sun());
        light_cells(scene, {.around_rays = 16});
        EXPECT_EQ(brightest_inside(scene, Lighting::gathered, 1), 0.0f);
        EXPECT_EQ(brightest_inside(scene, Lighting::reference, 1), 0.0f);
        EXPECT_EQ(brightest_inside(scene, Lighting::cached, 1), 0.0f);
    }
}

// Walls of one voxel, cells of two: what leaks is what a cell cannot tell apart.
TEST(SealedBox, WallsOfHalfACellLetLittleThrough) {
    for (const double degrees : {0.0, 17.0, 45.0}) {
        SCOPED_TRACE(degrees);
        const Dag dag = test::sealed_box(6, 18.3, degrees, 1.0);
        LitScene scene = scene_of(dag, grey(dag, 5, 230), Sky::constant(vec3(1.0f)));
        light_cells(scene, {.around_rays = 16});
        EXPECT_EQ(brightest_inside(scene, Lighting::reference, 4), 0.0f);
        const float gathered = brightest_inside(scene, Lighting::gathered, 4);
        const float cached = brightest_inside(scene, Lighting::cached, 1);
        std::printf("half-voxel walls, %g degrees: gathered %.4f, cached %.4f of the sky\n",
                    degrees, static_cast<double>(gathered), static_cast<double>(cached));
        EXPECT_LT(gathered, 0.01f);
        EXPECT_LT(cached, 0.01f);
    }
}

TEST(WhiteFurnaceSlow, AWhiteBallCannotBeSeen) {
    const Dag dag =
        test::dag_of_distance(6, [](const dvec3& p) { return glm::length(p - 32.0) - 20.0; });
    LitScene scene = scene_of(dag, grey(dag, 6, 255), Sky::constant(vec3(1.0f)));
    light_cells(scene, {.bounces = 4});
    for (const Lighting lighting : {Lighting::gathered, Lighting::cached, Lighting::reference}) {
        const Image image =
            render_lit(scene, lighting, small_picture({32, 40, 90}, dvec3(32.0), 16));
        EXPECT_NEAR(mean_green(image), 1.0, 0.01) << static_cast<int>(lighting);
    }
}

TEST(WhiteFurnace, AClosedRoomThatShinesHasTheSumOfTheSeries) {
    const Dag dag = test::sealed_box(5, 10.3, 0.0, 1.0);
    const Attributes half = grey(dag, 5, 188, [](const uvec3&) { return 1.0f; });
    const double albedo = static_cast<double>(linear_from_srgb8(188));
    LitScene scene = scene_of(dag, half, {});
    const RenderOptions options = small_picture(dvec3(16.0), {20, 14, 17}, 16);
    const double all = 1.0 / (1.0 - albedo);
    EXPECT_NEAR(mean_green(render_lit(scene, Lighting::reference, options)), all, 0.01 * all);
    // Eight bounces are the series but for a hundredth; two and what is estimated are all of it.
    for (const LightOptions& light :
         {LightOptions{.bounces = 8, .estimate_rest = false}, LightOptions{.bounces = 2}}) {
        light_cells(scene, light);
        EXPECT_NEAR(mean_green(render_lit(scene, Lighting::gathered, options)), all, 0.01 * all);
        EXPECT_NEAR(mean_green(render_lit(scene, Lighting::cached, options)), all, 0.01 * all);
    }
}

TEST(EmissionAloneSlow, LightsARoomAsPathsDo) {
    const Dag dag = test::sealed_box(6, 20.3, 17.0, 1.0);
    const auto lamp = [](const uvec3& v) {
        return v.y > 50 && glm::length(dvec3(v) - dvec3(32, v.y, 32)) < 5.0 ? 20.0f : 0.0f;
    };
    LitScene scene = scene_of(dag, grey(dag, 6, 200, lamp), {});
    const RenderOptions options = small_picture({32, 30, 20}, {32, 20, 40}, 64);
    const double reference = mean_green(render_lit(scene, Lighting::reference, options));
    double before = 1.0;
    for (const bool rest : {false, true})
        for (const int bounces : {0, 2, 8}) {
            if (rest && bounces == 0) continue;
            light_cells(scene, {.bounces = bounces, .around_rays = 64, .estimate_rest = rest});
            const double gathered = mean_green(render_lit(scene, Lighting::gathered, options));
            const double cached = mean_green(render_lit(scene, Lighting::cached, options));
            const double error = std::abs(gathered / reference - 1.0);
            std::printf(
                "emission alone, %d bounces%s: gathered %.4f, cached %.4f of the reference\n",
                bounces, rest ? " and the rest" : "", gathered / reference, cached / reference);
            if (!rest) {
                EXPECT_LT(error, before);
            }
            before = error;
            if (rest || bounces == 8) {
                EXPECT_LT(error, 0.02);
                EXPECT_NEAR(cached / reference, 1.0, 0.03);
            }
        }
}

// Light is far less even in a niche than in the room that it opens to. A rest that was estimated
// from what arrives in the niche made its walls a rectangle that shone.
TEST(EmissionAloneSlow, LightsANicheAsPathsDo) {
    const auto in_box = [](const dvec3& p, const dvec3& centre, const dvec3& half) {
        const dvec3 d = glm::abs(p - centre) - half;
        return std::max({d.x, d.y, d.z});
    };
    const Dag dag = test::dag_of_voxels(6, [&](const dvec3& p) {
        const double d =
            std::min(in_box(p, {32, 32, 22}, {20, 20, 16}), in_box(p, {32, 32, 46}, {12, 16, 10}));
        return d >= 0.0 && d < 1.0;
    });
    const auto lamp = [](const uvec3& v) {
        return v.y > 50 && glm::length(dvec3(v) - dvec3(32, v.y, 14)) < 5.0 ? 20.0f : 0.0f;
    };
    LitScene scene = scene_of(dag, grey(dag, 6, 230, lamp), {});
    const RenderOptions options = small_picture({32, 32, 48}, {32, 32, 60}, 256);
    const double reference = mean_green(render_lit(scene, Lighting::reference, options));
    for (const int bounces : {2, 8}) {
        light_cells(scene, {.bounces = bounces});
        const double cached = mean_green(render_lit(scene, Lighting::cached, options));
        std::printf("niche, %d bounces and the rest: cached %.4f of the reference\n", bounces,
                    cached / reference);
        EXPECT_NEAR(cached / reference, 1.0, bounces == 2 ? 0.04 : 0.01);
    }
}

/// Where the reference has no light, how much another picture has: of the brightest the reference
/// has. @param allowed  of the reference, what counts as none
double most_where_dark(const Image& picture, const Image& reference, float allowed) {
    const float most = greatest_channel(reference);
    double found = 0.0;
    // A pixel is dark where its neighbours are too: cells end somewhere else than pixels.
    const int reach = 2;
    for (int y = reach; y < reference.height - reach; ++y)
        for (int x = reach; x < reference.width - reach; ++x) {
            float near = 0.0f;
            for (int dy = -reach; dy <= reach; ++dy)
                for (int dx = -reach; dx <= reach; ++dx)
                    near = std::max(near, reference.color[reference.index(x + dx, y + dy)].g);
            if (near > allowed * most) continue;
            found =
                std::max(found, static_cast<double>(picture.color[picture.index(x, y)].g / most));
        }
    return found;
}

void expect_dark_where_paths_are(const LitScene& scene, const dvec3& eye, const dvec3& at,
                                 const char* name) {
    RenderOptions options = small_picture(eye, at, 16);
    options.width = 64;
    options.height = 48;
    const Image reference = render_lit(scene, Lighting::reference, options);
    ASSERT_GT(greatest_channel(reference), 0.0f);
    const double gathered =
        most_where_dark(render_lit(scene, Lighting::gathered, options), reference, 0.005f);
    const double cached =
        most_where_dark(render_lit(scene, Lighting::cached, options), reference, 0.005f);
    std::printf("%s, where the reference is dark: gathered %.4f, cached %.4f\n", name, gathered,
                cached);
    EXPECT_LT(gathered, 0.01);
    EXPECT_LT(cached, 0.05);
}

/// All but black, so that what bounces is below a two hundredth.
constexpr std::uint8_t kDark = 13;

TEST(DoorAjarSlow, LightsNothingThatPathsDoNot) {
    // Two rooms, a wall of one voxel between them with a gap of three, a lamp in the first.
    const Dag dag = test::dag_of_voxels(6, [](const dvec3& p) {
        const bool box =
            std::max({std::abs(p.x - 32.0), std::abs(p.z - 32.0), std::abs(p.y - 32.0)}) > 29.5;
        const bool wall = p.x > 32.0 && p.x < 33.0 && !(p.z > 20.0 && p.z < 23.0 && p.y < 50.0);
        return box || wall;
    });
    LitScene scene = scene_of(dag, grey(dag, 6, kDark), {});
    scene.lights.push_back(test::lamp_at({12.0, 30.0, 12.0}, 3000.0f));
    light_cells(scene, {});
    for (const dvec3& eye : {dvec3(55, 40, 55), dvec3(12, 40, 55)})
        expect_dark_where_paths_are(scene, eye, {33, 10, 25}, "door ajar");
}

TEST(ConvexCorner, TheSideAwayFromTheLampStaysDark) {
    const Dag dag = test::dag_of_voxels(
        6, [](const dvec3& p) { return p.y < 8.0 || (p.x < 32.0 && p.z < 32.0 && p.y < 40.0); });
    LitScene scene = scene_of(dag, grey(dag, 6, kDark), {});
    scene.lights.push_back(test::lamp_at({20.0, 30.0, 55.0}, 3000.0f));
    light_cells(scene, {});
    expect_dark_where_paths_are(scene, {60, 36, 20}, {32, 20, 24}, "convex corner");
}

TEST(RenderLit, TwoRunsAndAnyThreadsGiveTheSamePicture) {
    const Dag dag = test::sealed_box(5, 10.3, 17.0, 1.0);
    const auto lamp = [](const uvec3& v) { return v.y > 24 ? 3.0f : 0.0f; };
    std::vector<Image> images;
    for (const int threads : {1, 2, 0}) {
        LitScene scene = scene_of(dag, grey(dag, 5, 200, lamp), Sky::clear({0, 1, 0}));
        light_cells(scene, {.threads = threads});
        RenderOptions options = small_picture(dvec3(16.0), {20, 14, 17}, 4);
        options.threads = threads;
        for (const Lighting l : {Lighting::gathered, Lighting::cached, Lighting::reference})
            images.push_back(render_lit(scene, l, options));
    }
    for (std::size_t i = 3; i < images.size(); ++i) EXPECT_EQ(images[i], images[i % 3]) << i;
}

/// What a pixel's light does from frame to frame beyond the slow change along the way (second
/// differences), of the mean, where it sees the same smooth surface in all three.
double flicker(const std::vector<Image>& frames) {
    double sum = 0.0, mean = 0.0, count = 0.0;
    for (std::size_t f = 1; f + 1 < frames.size(); ++f)
        for (std::size_t k = 0; k < frames[f].color.size(); ++k) {
            const float before = frames[f - 1].depth[k], at = frames[f].depth[k];
            const float after = frames[f + 1].depth[k];
            if (!(std::abs(before - at) + std::abs(after - at) < 0.05f * at)) continue;
            const double bend = static_cast<double>(
                frames[f - 1].color[k].g - 2.0f * frames[f].color[k].g + frames[f + 1].color[k].g);
            sum += bend * bend;
            mean += static_cast<double>(frames[f].color[k].g);
            count += 1.0;
        }
    EXPECT_GT(count, 1000.0);
    return std::sqrt(sum / count / 6.0) / (mean / count);
}

TEST(RenderLit, CachedLightDoesNotFlickerWhenTheCameraMoves) {
    const Dag dag = test::sealed_box(6, 20.3, 17.0, 1.0);
    const auto lamp = [](const uvec3& v) {
        return v.y > 50 && glm::length(dvec3(v) - dvec3(32, v.y, 32)) < 5.0 ? 20.0f : 0.0f;
    };
    LitScene scene = scene_of(dag, grey(dag, 6, 200, lamp), {});
    light_cells(scene, {.around_rays = 64});
    // A fly-through in steps of a tenth of a voxel.
    std::vector<Image> frames;
    for (int i = 0; i < 8; ++i) {
        RenderOptions options =
            small_picture({28.0 + 0.1 * i, 30, 20}, {32.0 + 0.1 * i, 22, 40}, 4);
        frames.push_back(render_lit(scene, Lighting::cached, options));
    }
    const double deviation = flicker(frames);
    std::printf("fly-through: deviation of a pixel %.4f of the mean\n", deviation);
    EXPECT_LT(deviation, 0.05);
}

TEST(RenderLit, LightDoesNotFlickerOnAWalkThroughTheCourtyard) {
    const Scene triangles = make_sample("courtyard", 0.02);
    BuildOptions how;
    how.depth = 8;
    const BuildResult built = build(triangles, how);
    LitScene scene;
    scene.objects.push_back(
        {.dag = built.dag,
         .grid = built.grid,
         .attributes = build_attributes(triangles, built.dag, built.grid, {.level = 7})});
    scene.sky = Sky::clear({0, 1, 0});
    scene.lights.push_back(sun_at(0.7, 0.9));
    light_cells(scene, {.around_rays = 16});
    const Camera walker = triangles.cameras.at(0);
    for (const Lighting lighting : {Lighting::gathered, Lighting::cached}) {
        std::vector<Image> frames;
        for (int i = 0; i < 6; ++i) {
            const dvec3 eye = walker.eye + 0.1 * i * built.grid.voxel_size * walker.forward;
            RenderOptions options = small_picture(eye, eye + walker.forward, 16);
            options.ao_samples = 256;
            frames.push_back(render_lit(scene, lighting, options));
        }
        const double deviation = flicker(frames);
        std::printf("courtyard: deviation of a pixel %.4f of the mean\n", deviation);
        EXPECT_LT(deviation, 0.05);
    }
}

}  // namespace
}  // namespace octavo
