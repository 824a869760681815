// SPDX-License-Identifier: MIT
#include "octavo/render/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "octavo/light/light_grid.h"
#include "octavo/trace/partitions.h"
#include "octavo/trace/trace.h"
#include "support/small_dags.h"

namespace octavo {
namespace {

/// A sphere over a floor, in a grid that is not at the origin.
const Dag& sphere_on_floor() {
    static const Dag dag = test::dag_of_distance(7, [](const dvec3& p) {
        return std::min(p.y - 20.4, glm::length(p - dvec3(64, 60, 64)) - 30.0);
    });
    return dag;
}
const Grid kGrid{{-3, 10, 5}, 0.125, 7};

RenderOptions small_picture() {
    RenderOptions options;
    options.width = 83;
    options.height = 45;
    options.samples = 2;
    options.ao_samples = 8;
    options.shadow_samples = 4;
    return options;
}

TEST(Render, BeamsChangeNoBitOfThePicture) {
    for (const bool level_of_detail : {false, true})
        for (const double distance : {0.4, 1.0, 3.0, 40.0}) {
            RenderOptions options = small_picture();
            const dvec3 centre = kGrid.bounds().centre();
            options.camera = look_at(centre + dvec3(7, 5, 9) * distance, centre, {0, 1, 0}, 0.9);
            options.level_of_detail = level_of_detail;
            options.beam = true;
            const Image with = render(sphere_on_floor(), kGrid, options);
            options.beam = false;
            EXPECT_TRUE(with == render(sphere_on_floor(), kGrid, options)) << distance;
        }
}

TEST(Render, LanesAndTablesChangeNoBitOfThePicture) {
    RenderOptions options = small_picture();
    const dvec3 centre = kGrid.bounds().centre();
    for (const Shadows shadows : {Shadows::hard, Shadows::soft})
        for (const double distance : {0.4, 3.0}) {
            options.camera = look_at(centre + dvec3(7, 5, 9) * distance, centre, {0, 1, 0}, 0.9);
            options.shadows = shadows;
            Partitions partitions(sphere_on_floor(), 4);
            partitions.make_all();
            options.partitions = &partitions;
            options.wide = true;
            const Image with = render(sphere_on_floor(), kGrid, options);
            const std::uint64_t earned = partitions.earned();
            options.wide = false;
            EXPECT_TRUE(with == render(sphere_on_floor(), kGrid, options)) << distance;
            EXPECT_EQ(partitions.earned(), earned);
        }
}

TEST(Render, ThreadsChangeNoBitOfThePicture) {
    RenderOptions options = small_picture();
    options.threads = 1;
    const Image one = render(sphere_on_floor(), kGrid, options);
    for (const int threads : {2, 3, 8}) {
        options.threads = threads;
        EXPECT_TRUE(one == render(sphere_on_floor(), kGrid, options)) << threads;
    }
    options.frame = 1;
    EXPECT_FALSE(one == render(sphere_on_floor(), kGrid, options));
}

TEST(Render, UnitOfTheWorldChangesNoBitOfThePicture) {
    const Image one = render(sphere_on_floor(), kGrid, small_picture());
    for (const int power : {-100, -30, 30, 100}) {
        Grid grid = kGrid;
        grid.origin *= std::exp2(power);
        grid.voxel_size *= std::exp2(power);
        RenderOptions options = small_picture();
        EXPECT_TRUE(one.color == render(sphere_on_floor(), grid, options).color) << power;
        options.camera = default_camera(framed_box(sphere_on_floor(), grid), options.up,
                                        static_cast<double>(options.width) / options.height);
        EXPECT_TRUE(one.color == render(sphere_on_floor(), grid, options).color) << power;
    }
}

TEST(Render, LitPlaneHasNoAcne) {
    // Straight, and slanted so that it is a staircase; sunlit at 60 degrees and at a grazing 15.
    for (const ivec3& a : {ivec3(0, 1, 0), ivec3(1, 7, 2), ivec3(-3, 11, 4)})
        for (const double elevation : {0.26, 1.05}) {
            const Dag dag = test::slanted_wall(8, a, (a.x + a.y + a.z) * 128);
            const Grid grid{dvec3(0), 1.0, 8};
            RenderOptions options = small_picture();
            options.camera = look_at({128, 230, 128.1}, {128, 128, 128}, {0, 0, 1}, 0.5);
            const dvec3 normal = glm::normalize(dvec3(a));
            options.lights = {sun_at(0.4, elevation, normal)};
            options.shadows = Shadows::soft;
            options.ao_radius = 20.0;
            const Image image = render(dag, grid, options);
            double low = 1e9;
            double high = 0.0;
            double sum = 0.0;
            for (const vec3& color : image.color) {
                low = std::min<double>(low, color.y);
                high = std::max<double>(high, color.y);
                sum += color.y;
            }
            const double mean = sum / static_cast<double>(image.color.size());
            EXPECT_GT(low, 0.75 * mean) << a.x << elevation;
            EXPECT_LT(high, 1.25 * mean) << a.x << elevation;
        }
}

TEST(Render, ChangeOfLevelLeavesNoLineOnAFloor) {
    // The floor's top is in the lower half of every larger cell that holds it.
    const Dag dag = test::slanted_wall(9, {0, 1, 0}, 256);
    for (const bool smooth : {false, true}) {
        RenderOptions options = small_picture();
        options.camera = look_at({20, 290, 256}, {256, 257, 256}, {0, 1, 0}, 0.25);
        options.smooth_normals = smooth;
        options.lights = {sun_at(0.4, 1.0)};
        options.ao_radius = 5.0;
        const Image image = render(dag, {dvec3(0), 1.0, 9}, options);
        int floor = 0;
        for (std::size_t i = 0; i < image.color.size(); ++i) {
            if (image.depth[i] > 400.0f) continue;  // the floor's end and the sky
            ++floor;
            ASSERT_NEAR(image.color[i].y, image.color.back().y, 0.03f) << i;
        }
        EXPECT_GT(floor, 1500);
    }
}

TEST(Render, FacesOfAnAxisAlignedPlaneAreEvenToTheBit) {
    const Dag dag = test::slanted_wall(7, {0, 1, 0}, 64);
    RenderOptions options = small_picture();
    options.camera = look_at({64, 120, 64.1}, {64, 64, 64}, {0, 0, 1}, 0.5);
    options.smooth_normals = false;
    options.lights = {sun_at(0.4, 0.02)};  // grazing: every ray runs along the faces
    options.lights->front().size = 0.01;
    const Image image = render(dag, {dvec3(0), 1.0, 7}, options);
    for (const vec3& color : image.color) ASSERT_EQ(color, image.color[0]);
}

TEST(Render, SunAndLampsCastShadowsOntoTheFloor) {
    const Grid grid{dvec3(0), 1.0, 7};
    const auto brightness = [&](const Light& light, Shadows shadows, const dvec3& at) {
        RenderOptions options = small_picture();
        options.width = options.height = 1;
        options.samples = 1;
        options.ao_samples = 0;
        options.shadows = shadows;
        options.lights = {light};
        options.camera = look_at(at + dvec3(0, 4, 0.01), at, {0, 0, 1}, 0.1);
        return render(sphere_on_floor(), grid, options).color[0].x;
    };
    Light lamp;
    lamp.kind = Light::Kind::point;
    lamp.position = {64, 170, 64};
    lamp.intensity = vec3(20000.0f);
    Light spot = lamp;
    spot.kind = Light::Kind::spot;
    spot.direction = {0, -1, 0};
    spot.outer_angle = 0.45;
    const dvec3 below(64, 21, 64);
    const dvec3 beside(64, 21, 14);
    for (const Light& light : {sun_at(0.0, 1.5), lamp, spot})
        for (const Shadows shadows : {Shadows::hard, Shadows::soft}) {
            const float open = brightness(light, Shadows::none, below);
            EXPECT_LT(brightness(light, shadows, below), 0.75f * open);
            EXPECT_EQ(brightness(light, shadows, beside), brightness(light, Shadows::none, beside));
        }
    // Outside the cone there is the sky's light alone.
    const dvec3 corner(4, 21, 4);
    lamp.intensity = vec3(0.0f);
    EXPECT_EQ(brightness(spot, Shadows::none, {124, 21, 124}),
              brightness(lamp, Shadows::none, {124, 21, 124}));
    EXPECT_EQ(brightness(spot, Shadows::hard, corner), brightness(lamp, Shadows::hard, corner));
}

/// A floor z < 20 below a panel of voxels at z = 90, which is where the lamps are.
Dag floor_below_panel() {
    const auto in = [](const dvec3& v) {
        return v.z < 20 || (v.z == 90 && std::abs(v.x - 64) < 9 && std::abs(v.y - 64) < 5);
    };
    return test::dag_of(
        7, [](const uvec3&, std::uint32_t) { return true; },
        [&](const uvec3& v) { return in(dvec3(v)); });
}

TEST(Render, LampsWithAnAreaGiveTheLightOfTheirIntegral) {
    const Grid grid{{3, -2, 1}, 0.25, 7};
    const Dag dag = floor_below_panel();
    const double width = 8.0 * grid.voxel_size, height = 4.0 * grid.voxel_size;
    Light rectangle;
    rectangle.kind = Light::Kind::rectangle;
    rectangle.position = grid.to_world({64, 64, 90});
    rectangle.direction = {0, 0, -1};
    rectangle.half_u = {width, 0, 0};
    rectangle.half_v = {0, height, 0};
    Light disc = rectangle;
    disc.kind = Light::Kind::disc;
    disc.size = height;
    Light mesh = rectangle;
    mesh.kind = Light::Kind::mesh;
    const dvec3 corner = rectangle.position - rectangle.half_u - rectangle.half_v;
    const dvec3 u = 2.0 * rectangle.half_u, v = 2.0 * rectangle.half_v;
    mesh.triangles = {{corner, corner + u, corner + v}, {corner + u, corner + v, corner + u + v}};

    for (const dvec3& at : {dvec3(64.3, 64.2, 20), dvec3(90.3, 50.2, 20), dvec3(20.4, 101.3, 20)}) {
        const auto light = [&](const std::vector<Light>& lights) {
            RenderOptions options;
            options.width = options.height = 1;
            options.samples = 1;
            options.shadow_samples = 4096;
            options.ao_samples = 0;
            options.smooth_normals = false;
            options.lights = lights;
            const dvec3 target = grid.to_world(at);
            options.camera = look_at(target + dvec3(0, 0.001, 1), target, {0, 1, 0}, 1e-6);
            return static_cast<double>(render(dag, grid, options).color[0].x);
        };
        const double dark = light({});
        // The integral of cosine times cosine over the distance squared, by small squares.
        const auto expected = [&](bool round) {
            double sum = 0.0;
            const int n = 400;
            for (int i = 0; i < n * n; ++i) {
                const ivec2 square(i % n, i / n);
                const double a = (square.x + 0.5) / n * 2 - 1, b = (square.y + 0.5) / n * 2 - 1;
                if (round && a * a + b * b > 1.0) continue;
                const dvec3 way = rectangle.position +
                                  dvec3(a * (round ? height : width), b * height, 0.0) -
                                  grid.to_world(at);
                const double d = glm::length(way);
                sum += (way.z / d) * (way.z / d) / (d * d);
            }
            const double area = round ? 4 * height * height : 4 * width * height;
            return 0.78 / 3.141592653589793 * sum * area / (n * n);
        };
        const double as_rectangle = expected(false);
        EXPECT_NEAR(light({rectangle}) - dark, as_rectangle, 0.01 * as_rectangle) << at.x;
        EXPECT_NEAR(light({mesh}) - dark, as_rectangle, 0.01 * as_rectangle) << at.x;
        EXPECT_NEAR(light({disc}) - dark, expected(true), 0.01 * expected(true)) << at.x;
        EXPECT_NEAR(light({rectangle, disc}) - dark, as_rectangle + expected(true),
                    0.01 * (as_rectangle + expected(true)));
        // Seen from behind there is nothing; a mesh shines to both sides.
        Light away = rectangle;
        away.direction = {0, 0, 1};
        EXPECT_EQ(light({away}), dark);
    }
}

/// Finds a wall y = 12.5 that hides the lower half of the grid, which is no voxels.
void find_floor(std::span<const Ray> rays, std::span<SurfaceHit> hits) {
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const double t = (12.5 - rays[i].origin.y) / rays[i].direction.y;
        if (t > 0.0) hits[i] = {t, vec3(0, -3, 0)};
    }
}

TEST(Render, SurfaceOfTheCallerIsSeenInPlaceOfTheVoxels) {
    RenderOptions options = small_picture();
    options.camera = look_at({5, 17, 20}, {5, 12.5, 13}, {0, 1, 0}, 0.6);
    options.samples = 1;
    options.ao_radius = 3.0;
    options.lights = {sun_at(0.0, 1.5707963)};
    options.primary = find_floor;
    const Image image = render(sphere_on_floor(), kGrid, options);
    // The sphere is not seen, yet it shades what is below it, and the floor is nowhere dark beside.
    const vec3 below = image.color[image.index(41, 22)];
    const vec3 beside = image.color[image.index(2, 43)];
    EXPECT_LT(below.x, 0.5f * beside.x);
    EXPECT_NEAR(image.depth[image.index(41, 22)], std::sqrt(4.5 * 4.5 + 7.0 * 7.0), 0.01);
    options.primary = [](std::span<const Ray>, std::span<SurfaceHit>) {};
    for (const float depth : render(sphere_on_floor(), kGrid, options).depth)
        ASSERT_EQ(depth, std::numeric_limits<float>::infinity());
}

TEST(Render, DepthIsWorldDistanceAlongTheView) {
    RenderOptions options = small_picture();
    options.samples = 1;
    options.width = options.height = 1;
    options.level_of_detail = false;
    const double floor_y = kGrid.to_world({0, 21, 0}).y;
    for (const double above : {1.0, 12.0, 1e4, 1e9}) {
        const dvec3 at = kGrid.to_world({10.3, 0, 12.3});
        options.camera =
            look_at({at.x, floor_y + above, at.z}, {at.x, floor_y, at.z}, {0, 0, 1}, 1e-9);
        const Image image = render(sphere_on_floor(), kGrid, options);
        EXPECT_NEAR(image.depth[0], above, 1e-6 * above + 0.13) << above;
    }
}

TEST(Render, EmptyDagGivesTheSky) {
    const Image image = render(Dag(), Grid(), small_picture());
    for (const float depth : image.depth) ASSERT_EQ(depth, std::numeric_limits<float>::infinity());
    for (const vec3& color : image.color) ASSERT_GT(color.z, 0.1f);
}

TEST(Render, ReportsProgressToTheEndAndCanBeCancelled) {
    RenderOptions options = small_picture();
    std::uint64_t last = 0;
    options.progress = [&](const Progress& p) {
        EXPECT_EQ(p.phase, "render");
        EXPECT_GE(p.done, last);
        last = p.done;
        return true;
    };
    (void)render(sphere_on_floor(), kGrid, options);
    EXPECT_EQ(last, 83u * 45u);
    options.progress = [](const Progress& p) { return p.done < 1000; };
    try {
        (void)render(sphere_on_floor(), kGrid, options);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::cancelled);
    }
}

/// Lamps that each reach a tenth of what is seen.
std::vector<Light> many_lamps(int count) {
    std::vector<Light> lamps;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> part(0.0, 1.0);
    const Box box = kGrid.bounds();
    for (int i = 0; i < count; ++i) {
        Light lamp;
        lamp.kind = Light::Kind::point;
        const dvec3 at(part(random), 0.2 + 0.6 * part(random), part(random));
        lamp.position = box.low + at * box.size();
        lamp.intensity = vec3(0.005f);
        lamp.size = 0.05;
        lamps.push_back(lamp);
    }
    return lamps;
}

TEST(Render, LampsThatAreFarAwayAreNotAskedAndMakeNoDifferenceAboveTheLeastLight) {
    RenderOptions options = small_picture();
    constexpr int kCount = 200;
    options.lights = many_lamps(kCount);
    options.sky = Sky::constant(vec3(0.0f));
    ASSERT_LT(light_reach(options.lights->front(), options.least_light), 2.0);
    const Image near = render(sphere_on_floor(), kGrid, options);
    const float least = options.least_light;
    options.least_light = 0.0f;
    const Image all = render(sphere_on_floor(), kGrid, options);
    float most = 0.0f;
    for (std::size_t i = 0; i < all.color.size(); ++i) {
        const vec3 missing = all.color[i] - near.color[i];
        for (int c = 0; c < 3; ++c) {
            ASSERT_GE(missing[c], -1e-6f) << "a lamp too many";
            ASSERT_LE(missing[c], kCount * least);
            most = std::max(most, missing[c]);
        }
    }
    EXPECT_GT(most, 0.0f) << "all lamps were asked";

    // Where all of them reach every point, no bit differs.
    for (Light& lamp : *options.lights) lamp.intensity = vec3(100.0f);
    const Image bright = render(sphere_on_floor(), kGrid, options);
    options.least_light = least;
    EXPECT_TRUE(bright == render(sphere_on_floor(), kGrid, options));
}

TEST(Render, RefusesOptionsThatMakeNoPicture) {
    const auto refused = [](auto change) {
        RenderOptions options = small_picture();
        change(options);
        try {
            (void)render(sphere_on_floor(), kGrid, options);
        } catch (const Error& error) {
            return error.code() == Errc::bad_argument;
        }
        return false;
    };
    EXPECT_TRUE(refused([](RenderOptions& o) { o.width = 0; }));
    EXPECT_TRUE(refused([](RenderOptions& o) { o.samples = 0; }));
    EXPECT_TRUE(refused([](RenderOptions& o) { o.ao_samples = -1; }));
    EXPECT_TRUE(refused([](RenderOptions& o) { o.ao_radius = std::nan(""); }));
    EXPECT_TRUE(refused([](RenderOptions& o) { o.least_light = -1.0f; }));
    EXPECT_TRUE(refused([](RenderOptions& o) { o.up = dvec3(0); }));
    EXPECT_TRUE(refused([](RenderOptions& o) { o.camera.emplace().vertical_fov = 4.0; }));
    EXPECT_TRUE(refused([](RenderOptions& o) { o.camera.emplace().forward = {0, 1, 0}; }));
}

TEST(ContentBounds, HoldAllVoxelsTightly) {
    for (const int depth : {2, 5, 8, 12}) {
        const std::uint32_t n = 1u << depth;
        const uvec3 low(n / 4, n / 2, 0);
        const uvec3 high(n / 4 + 1, n - 1, n / 2);
        const Dag dag = test::dag_of(
            depth,
            [&](const uvec3& corner, std::uint32_t width) {
                const auto holds = [&](const uvec3& v) {
                    return glm::all(glm::lessThanEqual(corner, v)) &&
                           glm::all(glm::lessThan(v, corner + width));
                };
                return holds(low) || holds(high);
            },
            [&](const uvec3& v) { return v == low || v == high; });
        const Box box = content_bounds(dag, {dvec3(0), 1.0, depth});
        const double slack = depth > 8 ? std::exp2(depth - 8) : 1.0;
        for (int a = 0; a < 3; ++a) {
            EXPECT_LE(box.low[a], low[a]);
            EXPECT_GT(box.low[a], low[a] - slack);
            EXPECT_GE(box.high[a], high[a] + 1.0);
            EXPECT_LT(box.high[a], high[a] + 1.0 + slack);
        }
    }
    EXPECT_TRUE(content_bounds(Dag(), Grid()).empty());
}

TEST(DefaultCamera, SeesTheWholeBoxFromOutside) {
    for (const dvec3& up : {dvec3(0, 1, 0), dvec3(0, 0, 1), dvec3(1, 0, 0), dvec3(0, 0, -2)})
        for (const double aspect : {0.3, 1.0, 1.78, 4.0}) {
            const Box box{{-3, 2, 100}, {5, 9, 103}};
            const Camera camera = default_camera(box, up, aspect);
            EXPECT_GT(glm::dot(camera.eye - box.centre(), up), 0.0);
            const dvec3 right = glm::cross(camera.forward, camera.up);
            const double half_height = std::tan(0.5 * camera.vertical_fov);
            for (int i = 0; i < 8; ++i) {
                const dvec3 corner(i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
                                   i & 4 ? box.high.z : box.low.z);
                const dvec3 way = corner - camera.eye;
                const double depth = glm::dot(way, camera.forward);
                ASSERT_GT(depth, 0.0);
                EXPECT_LT(std::abs(glm::dot(way, camera.up)) / depth, half_height * 1.01);
                EXPECT_LT(std::abs(glm::dot(way, right)) / depth, half_height * aspect * 1.01);
            }
        }
}

}  // namespace
}  // namespace octavo
