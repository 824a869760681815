// SPDX-License-Identifier: MIT
#include "octavo/trace/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "octavo/core/parallel.h"
#include "support/exact_trace.h"
#include "support/random_rays.h"
#include "support/small_dags.h"

namespace octavo {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Dag one_voxel(int depth, const uvec3& voxel) {
    return test::dag_of(
        depth,
        [&](const uvec3& corner, std::uint32_t width) {
            for (int a = 0; a < 3; ++a)
                if (voxel[a] < corner[a] || voxel[a] >= corner[a] + width) return false;
            return true;
        },
        [&](const uvec3& v) { return v == voxel; });
}

TEST(Trace, EmptyDagIsMissed) {
    EXPECT_FALSE(trace_closest(Dag(), Ray{{1, 1, -5}, {0, 0, 1}}));
    EXPECT_FALSE(trace_any(test::SmallDagBuilder(9).freeze(0), Ray{{1, 1, -5}, {0, 0, 1}}));
}

TEST(Trace, HitNamesVoxelLevelFaceAndTime) {
    for (const int depth : {2, 3, 9, 17}) {
        const Dag dag = one_voxel(depth, {1, 2, 3});
        const Hit hit = trace_closest(dag, Ray{{1.5, 2.5, -7}, {0, 0, 2}});
        ASSERT_TRUE(hit) << depth;
        EXPECT_EQ(hit.path, uvec3(1, 2, 3));
        EXPECT_EQ(hit.level, depth);
        EXPECT_EQ(hit.face, Face::low_z);
        EXPECT_EQ(hit.normal(), dvec3(0, 0, -1));
        EXPECT_EQ(hit.t, 5.0);
        EXPECT_EQ(trace_closest(dag, Ray{{9, 2.25, 3.5}, {-1, 0, 0}}).face, Face::high_x);
    }
}

TEST(Trace, WorldRayAndGridRayAgree) {
    const Grid grid{{100, -200, 5.7e6}, 0.25, 9};
    const Dag dag = one_voxel(9, {100, 200, 300});
    const Ray ray{grid.to_world({100.5, 200.5, 10}), {0, 0, 4}};
    const Hit hit = trace_closest(dag, grid, ray);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit.t, 290 * 0.25 / 4, 1e-9);
    EXPECT_EQ(hit.path, uvec3(100, 200, 300));
}

TEST(Trace, RayFromInsideAVoxelHitsItAtItsStart) {
    const Dag dag = one_voxel(6, {10, 10, 10});
    const Hit hit = trace_closest(dag, Ray{{10.5, 10.5, 10.5}, {1, 1, 1}});
    EXPECT_EQ(hit.face, Face::inside);
    EXPECT_EQ(hit.t, 0.0);
    EXPECT_EQ(trace_closest(dag, Ray{{0.5, 10.5, 10.5}, {1, 0, 0}, 10.25}).t, 10.25);
}

TEST(Trace, RayOnAPlaneIsInItsUpperVoxelWhateverTheSignOfZero) {
    for (const double zero : {0.0, -0.0}) {
        const Ray ray{{5, 7, -1}, {zero, zero, 1}};
        EXPECT_TRUE(trace_any(one_voxel(5, {5, 7, 20}), ray));
        EXPECT_FALSE(trace_any(one_voxel(5, {4, 7, 20}), ray));
        EXPECT_FALSE(trace_any(one_voxel(5, {5, 6, 20}), ray));
    }
}

TEST(Trace, IntervalIsHalfOpen) {
    const Dag dag = one_voxel(5, {8, 8, 8});
    const Ray ray{{8.5, 8.5, 0}, {0, 0, 1}};
    EXPECT_FALSE(trace_any(dag, {ray.origin, ray.direction, 0, 8}));
    EXPECT_TRUE(trace_any(dag, {ray.origin, ray.direction, 0, 8.001}));
    EXPECT_FALSE(trace_any(dag, {ray.origin, ray.direction, 9, 100}));
    EXPECT_TRUE(trace_any(dag, {ray.origin, ray.direction, 8.999, 100}));
    EXPECT_FALSE(trace_any(dag, {ray.origin, ray.direction, 5, 5}));
}

TEST(Trace, HitsBehindTheOriginAreFoundWithANegativeStart) {
    const Dag dag = one_voxel(5, {8, 8, 8});
    const Hit hit = trace_closest(dag, Ray{{8.5, 8.5, 1000}, {0, 0, 1}, -kInf});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit.t, -992.0);
}

TEST(Trace, NotANumberAndInfinityMiss) {
    const Dag dag = test::dust(5, 0.9, 1);
    for (const double bad : {kNan, kInf, -kInf})
        for (int axis = 0; axis < 3; ++axis) {
            Ray ray{{16, 16, -4}, {0.1, 0.1, 1}};
            ray.origin[axis] = bad;
            EXPECT_FALSE(trace_closest(dag, ray));
            ray = {{16, 16, -4}, {0.1, 0.1, 1}};
            ray.direction[axis] = bad;
            EXPECT_FALSE(trace_any(dag, ray));
        }
    EXPECT_FALSE(trace_any(dag, Ray{{16, 16, -4}, {0, 0, 0}}));
    EXPECT_FALSE(trace_any(dag, Ray{{16, 16, -4}, {0, 0, 1}, kNan}));
    EXPECT_FALSE(trace_any(dag, Ray{{16, 16, -4}, {0, 0, 1}, 0, kNan}));
}

TEST(Trace, DirectionsOfAnyLengthGiveTheSameVoxel) {
    const Dag dag = test::dust(8, 0.5, 2);
    test::RandomRays rays(6, 256);
    for (int i = 0; i < 3000; ++i) {
        const Ray ray = rays(test::RandomRays::outside);
        const Hit hit = trace_closest(dag, ray);
        for (const double length : {0x1p-1020, 0x1p-200, 0x1p40, 0x1p1000}) {
            Ray scaled = ray;
            scaled.direction *= length;
            const Hit other = trace_closest(dag, scaled);
            ASSERT_EQ(bool(hit), bool(other)) << length;
            ASSERT_EQ(hit.path, other.path) << length;
        }
    }
    EXPECT_TRUE(trace_any(one_voxel(4, {3, 3, 3}), Ray{{3.5, 3.5, -2}, {0, 0, 5e-324}}));
}

TEST(Trace, FarOriginsLoseNoPrecision) {
    const Dag dag = test::slanted_wall(17, {3, -5, 7}, 300001);
    test::RandomRays random(3, 1 << 17);
    int grazes = 0;
    for (int i = 0; i < 8000; ++i) {
        Ray ray = random(test::RandomRays::inside);
        ray.origin -= ray.direction * std::exp2(random.uniform(17, 40));
        const test::ExactRay exact{ray.origin, ray.direction};
        const test::ExactHit expected = test::trace_exact(dag, exact);
        const Hit hit = trace_closest(dag, ray);
        if (bool(hit) == expected.found && (!hit || hit.path == expected.voxel)) continue;
        ++grazes;
        ASSERT_TRUE(test::differ_by_a_graze(exact, bool(hit), hit.path, expected, 0.1)) << i;
    }
    EXPECT_LE(grazes, 200);
}

TEST(Trace, StopsAtTheChosenLevel) {
    const Dag dag = one_voxel(9, {100, 200, 300});
    const Ray ray{{100.5, 200.5, -3}, {0, 0, 1}};
    for (int level = 0; level <= 9; ++level) {
        const Hit hit = trace_closest(dag, ray, {.level = level});
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit.level, level);
        EXPECT_EQ(hit.path, uvec3(100, 200, 300) >> uvec3(9u - static_cast<unsigned>(level)));
        EXPECT_EQ(hit.t, 3.0 + hit.path.z * std::exp2(9 - level));
    }
}

TEST(Trace, StopsWhereACellSubtendsLessThanTheCone) {
    const Dag dag = one_voxel(9, {100, 200, 300});
    for (const double cone : {0.001, 0.01, 0.1, 1.0})
        for (const double distance : {2.0, 50.0, 1e4}) {
            const Ray ray{{100.5, 200.5, -distance}, {0, 0, 1}};
            const Hit hit = trace_closest(dag, ray, {.cone = cone});
            ASSERT_TRUE(hit);
            const double width = std::exp2(9 - hit.level);
            EXPECT_TRUE(hit.level == 9 || width < hit.t * cone * 1.0001);
            // Its parent, which the ray enters no later, was too wide to stop at.
            const double parent = std::floor(hit.path.z / 2) * 2 * width + distance;
            EXPECT_TRUE(hit.level == 0 || 2 * width >= parent * cone * 0.9999);
        }
}

TEST(Trace, ManyRaysGiveTheHitsOfEachForAnyThreads) {
    const Dag dag = test::dust(8, 0.5, 2);
    const Grid grid{{-1, 2, 3}, 0.5, 8};
    test::RandomRays random(6, 256);
    std::vector<Ray> rays(5000);
    for (Ray& ray : rays) {
        ray = random(test::RandomRays::outside);
        ray.origin = grid.to_world(ray.origin);
    }
    for (const int threads : {1, 2, 5}) {
        std::vector<Hit> hits(rays.size());
        std::vector<std::uint8_t> occluded(rays.size());
        with_threads(threads, [&] {
            trace_closest(dag, grid, rays, hits);
            trace_any(dag, grid, rays, occluded);
        });
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Hit hit = trace_closest(dag, grid, rays[i]);
            ASSERT_EQ(hit.face, hits[i].face);
            ASSERT_EQ(hit.path, hits[i].path);
            ASSERT_EQ(bool(hit), occluded[i] == 1);
        }
    }
}

TEST(Trace, RaysThatLeaveAHitNeverMeetItsCell) {
    const Dag dag = test::dust(17, 0.6, 8);
    test::RandomRays random(2, 1 << 17);
    int faces = 0;
    for (int i = 0; i < 60000; ++i) {
        const Ray ray = random(static_cast<test::RandomRays::Kind>(i % 6));
        const Hit hit = trace_closest(dag, ray);
        if (!hit || hit.face == Face::inside) continue;
        ++faces;
        dvec3 away = random.direction();
        if (i % 4 == 0) away[random.integer(0, 2)] = 0.0;
        const Hit next = trace_closest(dag, leave_hit(dag, ray, hit, away));
        ASSERT_FALSE(next && next.path == hit.path) << i;
    }
    EXPECT_GT(faces, 10000);
}

}  // namespace
}  // namespace octavo
