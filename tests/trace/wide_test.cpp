// SPDX-License-Identifier: MIT
#include "octavo/trace/wide.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "octavo/trace/partitions.h"
#include "octavo/voxelize/tile_rasterizer.h"
#include "support/random_rays.h"
#include "support/sanitized.h"
#include "support/small_dags.h"

namespace octavo {
namespace {

namespace s = shared;

/// Runs each test on every SIMD target of this machine, and puts the choice back.
class Wide : public testing::TestWithParam<const char*> {
protected:
    void SetUp() override { force_simd_target(GetParam()); }
    void TearDown() override { force_simd_target(nullptr); }
};
INSTANTIATE_TEST_SUITE_P(AllTargets, Wide, testing::ValuesIn(simd_targets()),
                         [](const auto& target) { return std::string(target.param); });

void expect_same(const Dag& dag, const std::vector<s::GridRay>& rays, const s::Stop& stop,
                 const std::string& what) {
    std::vector<s::GridHit> expected;
    for (const s::GridRay& ray : rays) expected.push_back(trace_closest(s::view(dag), ray, stop));
    for (const WideWalk walk : {WideWalk::near_nodes, WideWalk::far_nodes}) {
        std::vector<s::GridHit> hits(rays.size());
        std::vector<std::uint8_t> occluded(rays.size(), 77);
        trace_closest_wide(dag, rays, stop, hits, walk);
        trace_any_wide(dag, rays, stop, occluded, nullptr, walk);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const s::GridHit& hit = expected[i];
            ASSERT_EQ(hit.face, hits[i].face) << what << " ray " << i;
            ASSERT_EQ(std::bit_cast<std::uint32_t>(hit.t), std::bit_cast<std::uint32_t>(hits[i].t))
                << what << " ray " << i;
            ASSERT_EQ(hit.path, hits[i].path) << what << " ray " << i;
            ASSERT_EQ(hit.height, hits[i].height) << what << " ray " << i;
            ASSERT_EQ(hit.face != s::kFaceNone ? 1 : 0, occluded[i]) << what << " ray " << i;
        }
    }
}

TEST_P(Wide, GivesTheBitsOfTheSharedText) {
    for (int depth = 2; depth <= 17; ++depth)
        for (const Dag& dag :
             {test::dust(depth, 0.5, 4), test::slanted_wall(depth, {3, -5, 7}, (3 << depth) / 2)}) {
            test::RandomRays random(static_cast<std::uint32_t>(depth),
                                    static_cast<int>(dag.resolution()));
            std::vector<s::GridRay> rays;
            for (int i = 0; i < 1200; ++i) {
                rays.push_back(
                    test::grid_ray(random(static_cast<test::RandomRays::Kind>(i / 200))));
                if (i % 5 == 0) rays.back().t_max = static_cast<float>(dag.resolution()) * 0.4f;
                if (i % 7 == 0) rays.back().t_min = static_cast<float>(dag.resolution()) * 0.2f;
                if (i % 11 == 0) rays.back().t_min = -1e9f;
            }
            const std::string what = "depth " + std::to_string(depth);
            expect_same(dag, rays, {0, 0.0f, 0.0f}, what);
            expect_same(dag, rays, {1, 0.0f, 0.0f}, what + " to blocks");
            expect_same(dag, rays, {depth / 2, 0.0f, 0.0f}, what + " to half");
            expect_same(dag, rays, {depth, 0.0f, 0.0f}, what + " to the root");
            expect_same(dag, rays, {0, 0.01f, 0.0f}, what + " cone");
            expect_same(dag, rays, {0, 0.1f, 20.0f}, what + " cone, from before");
            for (const std::size_t count : {0, 1, 15, 16, 17, 65})
                expect_same(dag, {rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(count)},
                            {0, 0.0f, 0.0f}, what + " few rays");
        }
}

TEST_P(Wide, GivesTheBitsForRaysThatLeaveOneFace) {
    for (const int depth : {3, 8, 12, 17}) {
        const Dag dag = test::dust(depth, 0.6, 8);
        test::RandomRays random(2, static_cast<int>(dag.resolution()));
        std::vector<s::GridRay> rays;
        while (rays.size() < 64 * 40) {
            const s::GridRay ray = test::grid_ray(random(test::RandomRays::outside));
            const s::GridHit hit = trace_closest(s::view(dag), ray, {0, 0.0f, 0.0f});
            if (hit.face >= s::kFaceInside) continue;
            for (int i = 0; i < 64; ++i) {
                dvec3 away = random.direction();
                if (i % 4 == 0) away[random.integer(0, 2)] = 0.0;
                rays.push_back(leave_hit(ray, hit, vec3(away)));
                rays.back().t_max = static_cast<float>(random.uniform(0, 100));
            }
        }
        expect_same(dag, rays, {0, 0.0f, 0.0f}, "depth " + std::to_string(depth));
        expect_same(dag, rays, {0, 0.15f, 0.0f}, "depth " + std::to_string(depth) + " cone");
    }
}

/// Groups of 64 rays from close together, in whose way the DAG may be, as lights make them.
class LightRays {
public:
    enum Kind { sun, soft_sun, lamp, past_lamp, apart, axis, short_ones, from_outside, kinds };

    LightRays(const Dag& dag, std::uint32_t seed)
        : size_(dag.resolution()), random_(seed, static_cast<int>(dag.resolution())) {}

    void add(Kind kind, std::vector<s::GridRay>& rays) {
        const double spread = std::exp2(random_.uniform(-2.0, std::log2(size_) - 1.0));
        const dvec3 away = kind == from_outside ? random_.direction() * (3.0 * size_) : dvec3(0.0);
        const dvec3 middle = place() + away;
        const dvec3 light = place();
        const dvec3 other = place();
        dvec3 direction =
            kind == from_outside ? glm::normalize(place() - middle) : random_.direction();
        if (kind == axis) {
            direction = dvec3(0.0);
            direction[random_.integer(0, 2)] = random_.flip() ? 1.0 : -1.0;
        }
        for (int i = 0; i < 64; ++i) {
            const dvec3 origin = (kind == apart && i % 3 == 0 ? other : middle) +
                                 spread * dvec3(random_.uniform(-1, 1), random_.uniform(-1, 1),
                                                random_.uniform(-0.1, 0.1));
            dvec3 way = direction;
            if (kind == soft_sun) way += 0.02 * random_.direction();
            if (kind == lamp || kind == past_lamp) way = light - origin + 3.0 * random_.direction();
            rays.push_back(test::grid_ray({dvec3(vec3(origin)), dvec3(vec3(way))}));
            if (kind == lamp) rays.back().t_max = 1.0f;
            if (kind == short_ones)
                rays.back().t_max = static_cast<float>(random_.uniform(0, size_));
            if (i % 13 == 0) rays.back().t_min = static_cast<float>(random_.uniform(0, 10));
        }
    }

private:
    dvec3 place() {
        return {random_.uniform(0, size_), random_.uniform(0, size_), random_.uniform(0, size_)};
    }

    double size_;
    test::RandomRays random_;
};

/// How many of the rays partitions answered, after a comparison of all with the shared text.
std::uint64_t count_proven(const Dag& dag, Partitions& partitions,
                           const std::vector<s::GridRay>& rays, const s::Stop& stop,
                           const std::string& what) {
    const std::uint64_t before = partitions.earned();
    std::vector<std::uint8_t> occluded(rays.size(), 77);
    trace_any_wide(dag, rays, stop, occluded, &partitions);
    for (std::size_t i = 0; i < rays.size(); ++i)
        EXPECT_EQ(trace_any(s::view(dag), rays[i], stop) ? 1 : 0, occluded[i])
            << what << " group " << i / 64 << " ray " << i;
    return partitions.earned() - before;
}

std::vector<s::GridRay> light_rays(const Dag& dag, std::uint32_t seed) {
    LightRays random(dag, seed);
    std::vector<s::GridRay> rays;
    // Those of a kind follow each other: with the first kind's directions all are told to be alike.
    for (int i = 0; i < 6 * LightRays::kinds; ++i)
        random.add(static_cast<LightRays::Kind>(i % LightRays::kinds), rays);
    rays.resize(rays.size() - 21);
    return rays;
}

TEST_P(Wide, PartitionsOccludeTheRaysThatTheSharedTextDoes) {
    std::uint64_t proven = 0;
    constexpr int kStep = test::kSanitized ? 4 : 1;
    for (int depth = 4; depth <= 17; depth += kStep)
        for (const Dag& dag : {test::dust(depth, 0.35, 4), test::dust(depth, 0.75, 5),
                               test::slanted_wall(depth, {3, -5, 7}, (3 << depth) / 2),
                               test::slanted_wall(depth, {0, 1, 0}, (1 << depth) / 3),
                               test::slanted_wall(depth, {1, 0, -1}, (1 << depth) / 5),
                               test::slanted_wall(depth, {1, 17, 2}, 5 << depth)}) {
            if (dag.empty()) continue;
            const auto rays = light_rays(dag, static_cast<std::uint32_t>(depth));
            for (int height = 3; height < std::min(depth, 8); height += kStep) {
                Partitions partitions(dag, height);
                partitions.make_all();
                ASSERT_EQ(partitions.height(), height);
                for (const s::Stop& stop :
                     {s::Stop{0, 0.0f, 0.0f}, s::Stop{3, 0.0f, 0.0f}, s::Stop{0, 0.02f, 5.0f}})
                    proven += count_proven(
                        dag, partitions, rays, stop,
                        "depth " + std::to_string(depth) + " height " + std::to_string(height));
                if (HasFailure()) return;
            }
        }
    EXPECT_GT(proven, test::kSanitized ? 5000u : 100000u);
}

TEST_P(Wide, PartitionsOccludeRaysAlongEdgesAndThroughCorners) {
    for (const ivec3& across : {ivec3(0, 1, 0), ivec3(1, 1, 0), ivec3(1, -1, 1)}) {
        const int depth = 9;
        const Dag dag = test::slanted_wall(depth, across, 200);
        Partitions partitions(dag, 5);
        partitions.make_all();
        for (int kind = 0; kind < test::RandomRays::kinds; ++kind) {
            test::RandomRays random(static_cast<std::uint32_t>(kind), 1 << depth);
            std::vector<s::GridRay> rays;
            for (int i = 0; i < 40; ++i) {
                // Copies of a ray beside each other by whole voxels: the same ties of planes.
                const s::GridRay one =
                    test::grid_ray(random(static_cast<test::RandomRays::Kind>(kind)));
                for (int k = 0; k < 64; ++k) {
                    rays.push_back(one);
                    rays.back().cell += ivec3(k & 3, k >> 2 & 3, k >> 4) - 2;
                }
                EXPECT_LE(count_proven(dag, partitions, rays, {0, 0.0f, 0.0f},
                                       "kind " + std::to_string(kind)),
                          64u);
                rays.clear();
            }
        }
    }
}

/// Rays into the middle of nodes of a wall that is one voxel thick, nearly level.
struct RaysIntoAWall {
    Dag dag = test::slanted_wall(11, {1, 17, 2}, 10760);
    std::vector<s::GridRay> rays;

    RaysIntoAWall() {
        for (int i = 0; i < 4096; ++i)
            rays.push_back(test::grid_ray({{600 + i / 64, 1900, 500 + i % 64}, {0.3, -1, 0.2}}));
    }
};

TEST_P(Wide, NearlyAllRaysIntoAWallAreAnsweredByPartitions) {
    const RaysIntoAWall wall;
    Partitions partitions(wall.dag);
    partitions.make_all();
    EXPECT_GT(count_proven(wall.dag, partitions, wall.rays, {0, 0.0f, 0.0f}, "wall"), 3600u);
}

TEST_P(Wide, PartitionsAreMadeAsRaysAskForThem) {
    const RaysIntoAWall wall;
    Partitions partitions(wall.dag);
    EXPECT_EQ(partitions.count(), 0u);
    for (int i = 0; i < 20; ++i)
        count_proven(wall.dag, partitions, wall.rays, {0, 0.0f, 0.0f}, "on demand");
    EXPECT_GT(partitions.count(), 0u);
    EXPECT_GT(partitions.earned(), 4096u);
}

TEST_P(Wide, NotANumberEndsWithoutAHit) {
    const Dag dag = test::dust(9, 0.9, 1);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<s::GridRay> rays(100, {ivec3(4), vec3(0.5f), vec3(0.1f, 0.3f, 1.0f), 0.0f, 1e9f});
    for (std::size_t i = 0; i < rays.size(); ++i)
        (i % 2 == 0 ? rays[i].t_min : rays[i].t_max) = nan;
    expect_same(dag, rays, {0, 0.0f, 0.0f}, "nan");
}

TEST_P(Wide, NotANumberDoesNotDisturbTheOtherRays) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Dag dag = test::slanted_wall(12, {3, -5, 7}, 6000);
    Partitions partitions(dag);
    partitions.make_all();
    LightRays light_rays(dag, 3);
    std::vector<s::GridRay> rays;
    for (int i = 0; i < 40; ++i) light_rays.add(LightRays::sun, rays);
    for (std::size_t i = 0; i < rays.size(); i += 5)
        (i % 2 == 0 ? rays[i].dir : rays[i].frac)[static_cast<int>(i % 3)] = nan;
    std::vector<std::uint8_t> occluded(rays.size());
    trace_any_wide(dag, rays, {0, 0.0f, 0.0f}, occluded, &partitions);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (i % 5 == 0) continue;
        ASSERT_EQ(trace_any(s::view(dag), rays[i], {0, 0.0f, 0.0f}) ? 1 : 0, occluded[i]) << i;
    }
}

void expect_same_start(const Dag& dag, const s::Bundle& beam, const s::Stop& stop,
                       const std::string& what) {
    ASSERT_EQ(beam_start(s::view(dag), beam, stop), beam_start_wide(dag, beam, stop)) << what;
}

/// About a ray, of any width: most have directions of one sign, some along an axis.
s::Bundle random_bundle(const s::GridRay& ray, test::RandomRays& random) {
    const float spread = static_cast<float>(std::exp2(random.uniform(-13, -1)));
    s::Bundle beam{ray.cell,
                   ray.frac,
                   ray.dir - 0.5f * spread,
                   ray.dir + 0.5f * spread,
                   0.0f,
                   random.flip() ? 1e30f : 1e9f,
                   spread};
    for (int a = 0; a < 3; ++a)
        if (ray.dir[a] == 0.0f) beam.dir_low[a] = random.flip() ? 0.0f : -0.0f;
    return beam;
}

TEST_P(Wide, BeamsStartWhereTheSharedTextSays) {
    std::size_t helped = 0;
    for (int depth = 2; depth <= 17; ++depth)
        for (const Dag& dag : {test::dust(depth, 0.35, 4), test::dust(depth, 0.6, 5),
                               test::slanted_wall(depth, {3, -5, 7}, (3 << depth) / 2)}) {
            const auto size = static_cast<float>(dag.resolution());
            test::RandomRays random(static_cast<std::uint32_t>(depth),
                                    static_cast<int>(dag.resolution()));
            for (int i = 0; i < 600; ++i) {
                const s::GridRay ray =
                    test::grid_ray(random(static_cast<test::RandomRays::Kind>(i / 100)));
                s::Bundle beam = random_bundle(ray, random);
                if (i % 5 == 0) beam.t_max = 0.4f * size;
                if (i % 7 == 0) beam.t_min = 0.2f * size;
                if (i % 11 == 0) beam.t_min = -1e9f;
                if (i % 13 == 0) beam.spread = 0.0f;
                const std::string what =
                    "depth " + std::to_string(depth) + " beam " + std::to_string(i);
                const float cone = beam.spread / 8.0f;
                for (const s::Stop& stop :
                     {s::Stop{0, 0.0f, 0.0f}, s::Stop{1, 0.0f, 0.0f},
                      s::Stop{depth / 2, 0.0f, 0.0f}, s::Stop{depth, 0.0f, 0.0f},
                      s::Stop{0, cone, 0.0f}, s::Stop{0, cone, 20.0f}})
                    expect_same_start(dag, beam, stop, what);
                const float start = beam_start_wide(dag, beam, {0, 0.0f, 0.0f});
                helped += start > beam.t_min && start < beam.t_max;
            }
        }
    EXPECT_GT(helped, 5000u);
}

TEST_P(Wide, BeamsOfNoNumberOrNoVoxelStartWhereTheSharedTextSays) {
    const Dag dag = test::dust(9, 0.6, 1);
    const Dag empty = test::SmallDagBuilder(9).freeze(0);
    const s::Bundle plain{
        ivec3(4), vec3(0.5f), vec3(0.1f, 0.3f, 0.9f), vec3(0.2f, 0.4f, 1.0f), 0.0f, 1e30f, 0.1f};
    expect_same_start(empty, plain, {0, 0.0f, 0.0f}, "empty");
    for (const float odd :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
          -std::numeric_limits<float>::infinity()})
        for (int i = 0; i < 14; ++i) {
            s::Bundle beam = plain;
            s::Stop stop{0, 0.01f, 0.0f};
            if (i < 9) (i < 3 ? beam.frac : i < 6 ? beam.dir_low : beam.dir_high)[i % 3] = odd;
            if (i == 9) beam.t_min = odd;
            if (i == 10) beam.t_max = odd;
            if (i == 11) beam.spread = odd;
            if (i == 12) stop.cone = odd;
            if (i == 13) stop.time_before = odd;
            const float expected = beam_start(s::view(dag), beam, stop);
            const float start = beam_start_wide(dag, beam, stop);
            EXPECT_TRUE(start == expected || (std::isnan(start) && std::isnan(expected)))
                << odd << " " << i << ": " << start << ", not " << expected;
        }
}

TEST_P(Wide, EmptyDagIsMissed) {
    const Dag empty = test::SmallDagBuilder(9).freeze(0);
    expect_same(empty, {100, test::grid_ray({{1, 1, -5}, {0, 0, 1}})}, {0, 0.0f, 0.0f}, "empty");
}

}  // namespace
}  // namespace octavo
