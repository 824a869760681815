// SPDX-License-Identifier: MIT
#include "octavo/render/visibility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "octavo/construct/build.h"
#include "octavo/core/parallel.h"
#include "support/random_rays.h"

namespace octavo {
namespace {

/// A large square through the origin with this normal, and a plank that stands on it from the
/// middle on: its foot is the line through the origin along `along`.
struct Corner {
    Scene scene;
    dvec3 normal, along, across;

    Corner(const dvec3& n, bool plank) : normal(glm::normalize(n)) {
        const dvec3 other = std::abs(normal.x) < 0.6 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
        along = glm::normalize(glm::cross(other, normal));
        across = glm::cross(normal, along);
        add(-3.0 * along - 3.0 * across, 6.0 * along, 6.0 * across);
        if (plank) add(-3.0 * along, 6.0 * along, 1.5 * normal);
    }
    void add(const dvec3& corner, const dvec3& u, const dvec3& v) {
        const auto first = static_cast<std::uint32_t>(scene.positions.size());
        for (const dvec3& p : {corner, corner + u, corner + v, corner + u + v})
            scene.positions.push_back(p);
        scene.triangles.emplace_back(first, first + 1, first + 2);
        scene.triangles.emplace_back(first + 1, first + 3, first + 2);
    }
};

BuildResult build_at(const Scene& scene, int depth) {
    BuildOptions options;
    options.depth = depth;
    return build(scene, options);
}

struct Points {
    std::vector<dvec3> positions;
    std::vector<vec3> normals;
};

Points points_on(const Corner& corner, double from, double to, int count, std::uint32_t seed) {
    test::RandomRays random(seed, 1);
    Points points;
    for (int i = 0; i < count; ++i) {
        points.positions.push_back(random.uniform(-1, 1) * corner.along +
                                   random.uniform(from, to) * corner.across);
        points.normals.emplace_back(corner.normal);
    }
    return points;
}

Light sun_from(const dvec3& towards) {
    Light sun;
    sun.direction = -glm::normalize(towards);
    return sun;
}

TEST(Visibility, NoPlaneOccludesItselfAtTheDefaultBiasInAnyDirection) {
    test::RandomRays random(5, 1);
    double unlifted = 1.0;
    for (int k = 0; k < 24; ++k) {
        dvec3 n = random.direction();
        if (k < 3) n = dvec3(k == 0, k == 1, k == 2);
        const Corner corner(n, false);
        const BuildResult built = build_at(corner.scene, 9);
        const Points points = points_on(corner, -1.0, 1.0, 200, 7);
        VisibilityOptions options{.ao_samples = 64, .ao_radius = 0.5};
        // A grazing sun, which sees the slightest step.
        options.light = sun_from(corner.normal * 0.02 + random.uniform(-1, 1) * corner.along +
                                 random.uniform(-1, 1) * corner.across);
        std::vector<float> shadow(200), ambient(200);
        for (const double bias : {1.0, 1.2, 2.0, 4.0}) {
            options.bias = bias;
            visibility(built.dag, built.grid, points.positions, points.normals, options, shadow,
                       ambient);
            for (std::size_t i = 0; i < shadow.size(); ++i) {
                ASSERT_EQ(shadow[i], 1.0f) << k << " bias " << bias;
                ASSERT_EQ(ambient[i], 1.0f) << k << " bias " << bias;
            }
        }
        options.bias = 0.25;
        visibility(built.dag, built.grid, points.positions, points.normals, options, shadow,
                   ambient);
        for (const float seen : ambient) unlifted = std::min(unlifted, double{seen});
    }
    EXPECT_LT(unlifted, 0.7);  // and a smaller bias does show acne
}

TEST(Visibility, NoLightLeaksThroughWhereAPlankMeetsTheFloor) {
    test::RandomRays random(6, 1);
    for (int k = 0; k < 12; ++k) {
        const Corner corner(random.direction(), true);
        const BuildResult built = build_at(corner.scene, 9);
        const double voxel = built.grid.voxel_size;
        // The sun is behind the plank and low enough to reach none of these points: all are dark,
        // from right behind the foot on.
        const Points points = points_on(corner, 0.01 * voxel, 1.0, 300, 8);
        VisibilityOptions options{.ao_samples = 0};
        options.light = sun_from(-1.0 * corner.across + 0.8 * corner.normal);
        std::vector<float> shadow(300);
        visibility(built.dag, built.grid, points.positions, points.normals, options, shadow, {});
        for (std::size_t i = 0; i < shadow.size(); ++i) {
            const double distance = glm::dot(points.positions[i], corner.across) / voxel;
            ASSERT_EQ(shadow[i], 0.0f) << k << ", " << distance << " voxels behind";
        }
        // And the lit side is lit, up to the voxels of the plank itself.
        const Points before = points_on(corner, -1.0, -4.0 * voxel, 300, 9);
        visibility(built.dag, built.grid, before.positions, before.normals, options, shadow, {});
        for (const float seen : shadow) ASSERT_EQ(seen, 1.0f) << k;
    }
}

TEST(Visibility, BiasOfOneIsTheLeastWithoutAcneAndLeavesNoGap) {
    // Walls of many slants with a plank on each: acne is shadow in front of it under a high sun,
    // a gap is light behind it under a low one.
    struct Fault {
        double bias;
        double acne = 0.0;  // part of the points
        double gap = 0.0;   // voxels behind the plank's middle, at most
    };
    std::vector<Fault> faults = {{0.25}, {0.5}, {0.75}, {1.0}, {1.5}, {2.0}, {4.0}};
    test::RandomRays random(11, 1);
    constexpr int kWalls = 10;
    for (int k = 0; k < kWalls; ++k) {
        const Corner corner(random.direction(), true);
        const BuildResult built = build_at(corner.scene, 9);
        const double voxel = built.grid.voxel_size;
        const Points front = points_on(corner, -1.0, -6.0 * voxel, 200, 21);
        const Points behind = points_on(corner, 0.01 * voxel, 12.0 * voxel, 200, 22);
        std::vector<float> shadow(200);
        for (Fault& fault : faults) {
            VisibilityOptions options{.ao_samples = 0, .bias = fault.bias};
            options.light = sun_from(corner.normal - 1.5 * corner.across);
            visibility(built.dag, built.grid, front.positions, front.normals, options, shadow, {});
            for (const float seen : shadow) fault.acne += (1.0 - seen) / (200.0 * kWalls);
            visibility(built.dag, built.grid, behind.positions, behind.normals, options, shadow,
                       {});
            for (std::size_t i = 0; i < shadow.size(); ++i)
                if (shadow[i] > 0.0f)
                    fault.gap =
                        std::max(fault.gap, glm::dot(behind.positions[i], corner.across) / voxel);
        }
    }
    for (const Fault& fault : faults) {
        if (fault.bias < 0.6) {
            EXPECT_GT(fault.acne, 0.0) << fault.bias;
        } else if (fault.bias >= 1.0) {
            EXPECT_EQ(fault.acne, 0.0) << fault.bias;
        }
        if (fault.bias <= 1.0) {
            EXPECT_EQ(fault.gap, 0.0) << fault.bias;
        }
        // A point's lift is what a low sun may shine below, and no more.
        EXPECT_LE(fault.gap, 1.5 * 1.75 * fault.bias) << fault.bias;
    }
}

TEST(Visibility, CornerSeesWhatTheIntegralSays) {
    const Corner corner({0, 1, 0}, true);
    const BuildResult built = build_at(corner.scene, 11);
    const double radius = 0.5;
    for (const double distance : {0.05, 0.15, 0.3}) {
        const Points points = points_on(corner, distance, distance + 1e-6, 64, 3);
        std::vector<float> ambient(64);
        visibility(built.dag, built.grid, points.positions, points.normals,
                   {.ao_samples = 256, .ao_radius = radius}, {}, ambient);
        // As in the test of ambient occlusion by a wall.
        double expected = 0.0;
        const int steps = 100000;
        const double least = distance / radius;
        for (int i = 0; i < steps; ++i) {
            const double u = least + (1.0 - least) * (i + 0.5) / steps;
            expected += 2.0 / 3.141592653589793 * (1.0 - least / u) * std::sqrt(1.0 - u * u) *
                        (1.0 - least) / steps;
        }
        double mean = 0.0;
        for (const float seen : ambient) mean += seen / 64.0;
        EXPECT_NEAR(1.0 - mean, expected, 0.02) << distance;
    }
}

TEST(Visibility, DoesNotDependOnThreadsAndLeavesOutWhatIsNoPoint) {
    const Corner corner({1, 2, 3}, true);
    const BuildResult built = build_at(corner.scene, 8);
    Points points = points_on(corner, -1.0, 1.0, 1000, 4);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    points.positions[10].y = nan;
    points.normals[20] = vec3(0.0f);
    points.normals[30] = vec3(static_cast<float>(nan));
    points.positions[40].x = 1e300;
    VisibilityOptions options{.shadow_samples = 32, .ao_radius = 1.0};
    options.light = sun_from(corner.normal + corner.across);
    options.light->size = 0.1;
    std::vector<float> shadow[2], ambient[2];
    for (int k = 0; k < 2; ++k) {
        shadow[k].resize(1000);
        ambient[k].resize(1000);
        with_threads(k == 0 ? 1 : 3, [&] {
            visibility(built.dag, built.grid, points.positions, points.normals, options, shadow[k],
                       ambient[k]);
        });
    }
    EXPECT_EQ(shadow[0], shadow[1]);
    EXPECT_EQ(ambient[0], ambient[1]);
    for (const std::size_t i : {10, 20, 30, 40}) {
        EXPECT_EQ(shadow[0][i], 1.0f) << i;
        EXPECT_EQ(ambient[0][i], 1.0f) << i;
    }
}

TEST(Visibility, RefusesArraysThatDifferInLength) {
    const std::vector<dvec3> positions(3);
    const std::vector<vec3> normals(2);
    std::vector<float> out(3);
    EXPECT_THROW(visibility(Dag(), Grid(), positions, normals, {.ao_radius = 1.0}, out, out),
                 Error);
}

}  // namespace
}  // namespace octavo
