// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/children_list.h"
#include "support/exact_trace.h"
#include "support/random_rays.h"
#include "support/small_dags.h"

namespace octavo {
namespace {

namespace s = shared;
constexpr s::Stop kToVoxels{0, 0.0f, 0.0f};

/// The ray that grid_ray() holds, as exactly as it holds it.
test::ExactRay exact_ray(const s::GridRay& ray) {
    return {origin_of(ray), dvec3(ray.dir), ray.t_min, ray.t_max};
}

/// How far a float's rounding may move the ray at the other end of the grid, in voxels.
double tolerance(const Dag& dag, const test::ExactRay& ray) {
    const double way = glm::length(ray.origin - 0.5 * dag.resolution()) + dag.resolution();
    return 4e-7 * way;
}

struct Count {
    int rays = 0;
    int hits = 0;
    int grazes = 0;
    int wrong = 0;
};

void compare(const Dag& dag, const s::GridRay& ray, Count& count) {
    const test::ExactRay exact = exact_ray(ray);
    const test::ExactHit expected = test::trace_exact(dag, exact);
    const s::GridHit hit = trace_closest(s::view(dag), ray, kToVoxels);
    const bool found = hit.face != s::kFaceNone;
    ++count.rays;
    count.hits += expected.found;
    if (found == expected.found && (!found || hit.path == expected.voxel)) {
        if (!found) return;
        const double error = std::abs(hit.t - expected.t) * glm::length(exact.direction);
        count.wrong += error > tolerance(dag, exact);
        return;
    }
    ++count.grazes;
    if (!test::differ_by_a_graze(exact, found, hit.path, expected, tolerance(dag, exact)))
        ++count.wrong;
}

class TraverseAgainstDouble : public testing::TestWithParam<int> {};

TEST_P(TraverseAgainstDouble, FindsTheSameVoxelsButForGrazes) {
    const int depth = GetParam();
    int grazes = 0;
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
        const Dag dag = test::dust(depth, 0.3 + 0.15 * seed, seed);
        test::RandomRays rays(seed + 10, static_cast<int>(dag.resolution()));
        for (int kind = 0; kind < test::RandomRays::kinds; ++kind) {
            Count count;
            for (int i = 0; i < 2500; ++i)
                compare(dag, test::grid_ray(rays(static_cast<test::RandomRays::Kind>(kind))),
                        count);
            EXPECT_EQ(count.wrong, 0) << "depth " << depth << " seed " << seed << " kind " << kind;
            // A ray passes some 10 to 100 edges of voxels, each within 1e-7 of the way: one in
            // thousands grazes. Diagonals and lattice rays meet edges exactly, where double rounds
            // too.
            EXPECT_LE(count.grazes, kind >= test::RandomRays::diagonal ? 75 : 20)
                << "depth " << depth << " seed " << seed << " kind " << kind;
            grazes += count.grazes;
        }
    }
    RecordProperty("grazes", grazes);
}
INSTANTIATE_TEST_SUITE_P(AllDepths, TraverseAgainstDouble, testing::Range(2, 18));

TEST(Traverse, FindsTheSameVoxelsFromFarAwayAtDepth17) {
    for (const Dag& dag : {test::dust(17, 0.5, 5), test::slanted_wall(17, {3, -5, 7}, 300001)}) {
        test::RandomRays random(3, 1 << 17);
        Count count;
        for (int i = 0; i < 10000; ++i) {
            Ray ray = random(test::RandomRays::inside);
            ray.origin -= 3e5 * ray.direction;
            compare(dag, test::grid_ray(ray), count);
        }
        EXPECT_EQ(count.wrong, 0);
        // The edges of the wall's voxels are all close to any ray, and the ray errs by 0.1 voxels.
        EXPECT_LE(count.grazes, 700);
        EXPECT_GT(count.hits, 500);
    }
}

TEST(Traverse, GivesTheBitsOfTheOtherTraversal) {
    for (const int depth : {2, 3, 6, 11, 17}) {
        const Dag dag = test::dust(depth, 0.5, 4);
        test::RandomRays rays(9, static_cast<int>(dag.resolution()));
        for (int i = 0; i < 30000; ++i) {
            s::GridRay ray = test::grid_ray(rays(static_cast<test::RandomRays::Kind>(i % 6)));
            if (i % 5 == 0) ray.t_max = static_cast<float>(dag.resolution()) * 0.4f;
            const s::Stop stop{i % 7 == 0 ? 1 : 0, i % 3 == 0 ? 0.01f : 0.0f, 0.0f};
            const s::GridHit a = trace_closest(s::view(dag), ray, stop);
            const s::GridHit b = trace_by_lists(s::view(dag), ray, stop);
            ASSERT_EQ(a.face, b.face) << depth << " " << i;
            ASSERT_EQ(a.t, b.t) << depth << " " << i;
            ASSERT_EQ(a.path, b.path) << depth << " " << i;
            ASSERT_EQ(a.height, b.height) << depth << " " << i;
        }
    }
}

TEST(Traverse, SecondaryRaysFromAFaceNeverHitTheCellTheyLeave) {
    for (const int depth : {4, 10, 17}) {
        const Dag dag = test::dust(depth, 0.6, 8);
        test::RandomRays random(2, static_cast<int>(dag.resolution()));
        int faces = 0;
        for (int i = 0; i < 60000; ++i) {
            const s::GridRay ray =
                test::grid_ray(random(static_cast<test::RandomRays::Kind>(i % 6)));
            const s::GridHit hit = trace_closest(s::view(dag), ray, kToVoxels);
            if (hit.face >= s::kFaceInside) continue;
            ++faces;
            vec3 away(random.direction());
            if (i % 4 == 0) away[random.integer(0, 2)] = random.flip() ? 0.0f : -0.0f;
            const float outward = hit.face % 2 == 1 ? 1.0f : -1.0f;
            if (away[hit.face / 2] * outward < 0.0f) away = -away;
            const s::GridHit next =
                trace_closest(s::view(dag), leave_hit(ray, hit, away), kToVoxels);
            ASSERT_FALSE(next.face != s::kFaceNone && next.path == hit.path) << depth << " " << i;
        }
        EXPECT_GT(faces, 5000);
    }
}

TEST(Beam, StartsNoRayOfTheBundleAfterItsHit) {
    for (const int depth : {3, 7, 12, 17}) {
        const Dag dag = test::dust(depth, 0.45, 6);
        test::RandomRays random(4, static_cast<int>(dag.resolution()));
        int helped = 0;
        for (int i = 0; i < 2000; ++i) {
            const s::GridRay centre = test::grid_ray(random(test::RandomRays::outside));
            const float spread = static_cast<float>(std::exp2(random.uniform(-12, -3)));
            s::Bundle beam;
            beam.cell = centre.cell;
            beam.frac = centre.frac;
            beam.dir_low = centre.dir - 0.5f * spread;
            beam.dir_high = centre.dir + 0.5f * spread;
            beam.t_min = 0.0f;
            beam.t_max = 1e9f;
            beam.spread = spread;
            const s::Stop stop{0, i % 2 == 0 ? spread / 8.0f : 0.0f, 0.0f};
            const float start = beam_start(s::view(dag), beam, stop);
            helped += start > 0.0f;
            for (int k = 0; k < 12; ++k) {
                s::GridRay ray = centre;
                for (int a = 0; a < 3; ++a)
                    ray.dir[a] =
                        static_cast<float>(random.uniform(beam.dir_low[a], beam.dir_high[a]));
                const s::GridHit full = trace_closest(s::view(dag), ray, stop);
                ray.t_min = start;
                const s::GridHit shortened = trace_closest(s::view(dag), ray, stop);
                ASSERT_EQ(full.face, shortened.face) << depth << " " << i;
                if (full.face == s::kFaceNone) continue;
                ASSERT_EQ(full.t, shortened.t);
                ASSERT_EQ(full.path, shortened.path);
                ASSERT_EQ(full.height, shortened.height);
            }
        }
        EXPECT_GT(helped, 1000);
    }
}

}  // namespace
}  // namespace octavo
