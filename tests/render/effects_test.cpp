// SPDX-License-Identifier: MIT
#include "octavo/render/effects.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "octavo/light/lamp.h"
#include "octavo/trace/partitions.h"
#include "octavo/trace/ray_queue.h"
#include "support/exact_trace.h"
#include "support/random_rays.h"
#include "support/small_dags.h"

namespace octavo {
namespace {

namespace s = shared;
constexpr s::Stop kToVoxels{0, 0.0f, 0.0f};

/// A floor of voxels z < 8, and a wall of voxels x < 8 if wanted.
Dag room_corner(int depth, bool wall) {
    return test::dag_of(
        depth, [](const uvec3&, std::uint32_t) { return true; },
        [wall](const uvec3& v) { return v.z < 8 || (wall && v.x < 8); });
}

s::GridRay on_floor(float x, float y) {
    return {ivec3(static_cast<int>(x), static_cast<int>(y), 8), vec3(0.5f, 0.5f, 0.0f),
            vec3(0, 0, 1), 0.0f, 1e30f};
}

TEST(Sampling, EveryPowerOfTwoFillsTheSquareEvenly) {
    for (const std::uint32_t seed : {1u, 77u, 123456u})
        for (const std::uint32_t n : {4u, 16u, 64u, 256u}) {
            // One sample in each column, in each row and in each cell of the finest square grid.
            const auto root = static_cast<std::uint32_t>(std::sqrt(n));
            std::set<std::uint32_t> columns, rows, cells, segments;
            for (std::uint32_t i = 0; i < n; ++i) {
                const vec2 p = s::sample_2d(i, seed);
                ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
                columns.insert(static_cast<std::uint32_t>(p.x * static_cast<float>(n)));
                rows.insert(static_cast<std::uint32_t>(p.y * static_cast<float>(n)));
                const vec2 cell = p * static_cast<float>(root);
                cells.insert(static_cast<std::uint32_t>(cell.x) +
                             root * static_cast<std::uint32_t>(cell.y));
                segments.insert(
                    static_cast<std::uint32_t>(s::sample_1d(i, seed) * static_cast<float>(n)));
            }
            EXPECT_EQ(columns.size(), n) << seed;
            EXPECT_EQ(rows.size(), n) << seed;
            EXPECT_EQ(cells.size(), n) << seed;
            EXPECT_EQ(segments.size(), n) << seed;
        }
}

TEST(Sampling, EachSquareHasOneOfItsSamplesForEverySeed) {
    for (const std::uint32_t seed : {0u, 1u, 77u, 123456u, 0xdeadbeefu})
        for (int m = 0; m <= 3; ++m) {
            const s::SquareOrder order = s::square_order(m, seed);
            const std::uint32_t squares = 1u << (2 * m);
            for (const std::uint32_t first : {0u, squares, 5u * squares, 1000u * squares})
                for (std::uint32_t square = 0; square < squares; ++square) {
                    const std::uint32_t i = s::sample_in_square(order, first, square);
                    EXPECT_EQ(i / squares, first / squares);
                    const vec2 at = s::sample_2d(i, seed) * static_cast<float>(1 << m);
                    EXPECT_EQ(
                        static_cast<std::uint32_t>(at.x) + (static_cast<std::uint32_t>(at.y) << m),
                        square);
                }
        }
}

TEST(Sampling, CosineDirectionsAverageToTwoThirdsOfTheNormal) {
    test::RandomRays random(1, 1);
    for (int k = 0; k < 20; ++k) {
        const vec3 n(random.direction());
        vec3 sum(0.0f);
        for (std::uint32_t i = 0; i < 1024; ++i) {
            const vec3 d = s::cosine_direction(n, s::sample_2d(i, 5));
            ASSERT_NEAR(glm::length(d), 1.0f, 1e-5f);
            ASSERT_GE(glm::dot(d, n), -1e-6f);
            sum += d / 1024.0f;
        }
        EXPECT_LT(glm::length(sum - n * (2.0f / 3.0f)), 0.01f);
    }
}

TEST(Surface, HitOverAnEdgeGoesToTheFaceThatIsOpen) {
    for (const bool before_x : {false, true}) {
        // Two voxels side by side; the ray comes exactly over the second one's edge.
        const uvec3 other = before_x ? uvec3(3, 4, 4) : uvec3(4, 4, 3);
        const Dag dag = test::dag_of(
            3, [](const uvec3&, std::uint32_t) { return true; },
            [&](const uvec3& v) { return v == uvec3(4, 4, 4) || v == other; });
        const s::GridRay ray{{1, 4, 1}, vec3(0.5f), vec3(1, 0, 1), 0.0f, 1e30f};
        const s::GridHit hit = s::trace_closest(s::view(dag), ray, kToVoxels);
        ASSERT_EQ(hit.path, uvec3(4, 4, 4));
        EXPECT_EQ(s::move_to_open_face(s::view(dag), ray, hit).face, before_x ? 4 : 0);
    }
}

TEST(AmbientOcclusion, OpenPlaneIsNotOccludedAtAll) {
    const Dag dag = room_corner(6, false);
    for (float x = 1; x < 63; x += 7)
        EXPECT_EQ(sky_samples_seen(s::view(dag), on_floor(x, 20), 5, vec3(0, 0, 1), 1e6f, kToVoxels,
                                   0, 256, 3u),
                  256);
}

TEST(AmbientOcclusion, WallOccludesWhatTheIntegralSays) {
    const Dag dag = room_corner(8, true);
    const double radius = 60.0;
    for (const double distance : {0.5, 4.5, 15.5, 30.5, 59.5}) {
        // Cosine-distributed directions are even on the unit disc; u is the component towards the
        // wall, at distance / u along the ray, which counts 1 - distance / (u radius).
        const double least = distance / radius;
        double expected = 0.0;
        const int steps = 100000;
        for (int i = 0; i < steps; ++i) {
            const double u = least + (1.0 - least) * (i + 0.5) / steps;
            expected += 2.0 / 3.141592653589793 * (1.0 - least / u) * std::sqrt(1.0 - u * u) *
                        (1.0 - least) / steps;
        }
        const int n = 1 << 14;
        const s::GridRay start = on_floor(static_cast<float>(8 + std::floor(distance)), 128);
        const int seen = sky_samples_seen(s::view(dag), start, 5, vec3(0, 0, 1),
                                          static_cast<float>(radius), kToVoxels, 0, n, 11u);
        EXPECT_NEAR(1.0 - static_cast<double>(seen) / n, expected, 0.004) << distance;
    }
}

TEST(AmbientOcclusion, EverySampleIsTakenOnceInWhateverOrder) {
    const Dag dag = test::dust(7, 0.5, 4);
    test::RandomRays random(12, 128);
    for (const ivec2 range : {ivec2(0, 64), ivec2(64, 192), ivec2(0, 6), ivec2(4, 20), ivec2(7, 8)})
        for (std::uint32_t seed = 0; seed < 40; ++seed) {
            const Ray world = random(test::RandomRays::inside);
            const s::GridRay start{ivec3(world.origin),
                                   vec3(world.origin - glm::floor(world.origin)), vec3(0, 0, 1),
                                   0.0f, 1e30f};
            int expected = 0;
            for (int i = range.x; i < range.y; ++i)
                expected += trace_any(s::view(dag),
                                      sky_ray(start, s::kFaceNone, vec3(0, 0, 1), 60.0f, i, seed),
                                      kToVoxels)
                                ? 0
                                : 1;
            EXPECT_EQ(sky_samples_seen(s::view(dag), start, s::kFaceNone, vec3(0, 0, 1), 60.0f,
                                       kToVoxels, range.x, range.y, seed),
                      expected);
        }
}

TEST(AmbientOcclusion, StoppingAtASolidAngleOnlyDarkens) {
    const Dag dag = test::dust(8, 0.5, 2);
    test::RandomRays random(8, 256);
    for (int k = 0; k < 300; ++k) {
        const Ray world = random(test::RandomRays::inside);
        const s::GridRay start{ivec3(world.origin), vec3(world.origin - glm::floor(world.origin)),
                               vec3(0, 0, 1), 0.0f, 1e30f};
        const auto seen = [&](float cone) {
            return sky_samples_seen(s::view(dag), start, s::kFaceNone, vec3(0, 0, 1), 60.0f,
                                    {0, cone, 0.0f}, 0, 64, 5u);
        };
        EXPECT_LE(seen(0.15f), seen(0.0f));
    }
}

TEST(Shadow, LampSamplesAgreeWithRaysInDouble) {
    const Dag dag = test::dust(7, 0.5, 3);
    test::RandomRays random(9, 128);
    int lit = 0;
    int dark = 0;
    int different = 0;
    for (int k = 0; k < 400; ++k) {
        const Ray world = random(test::RandomRays::inside);
        const s::GridRay start{ivec3(world.origin), vec3(world.origin - glm::floor(world.origin)),
                               vec3(0, 0, 1), 0.0f, 1e30f};
        const bool sun = k % 2 == 0;
        const s::LampPatch lamp =
            s::facing_disc(sun ? vec3(random.direction()) : vec3(random.direction()) * 30.0f,
                           sun ? 0.1f : 3.0f, sun ? 1e30f : 1.0f);
        for (int i = 0; i < 16; ++i) {
            const bool seen = lamp_samples_seen(s::view(dag), start, s::kFaceNone, lamp, kToVoxels,
                                                i, i + 1, 7u) == 1;
            const vec2 disc = s::disc_point(s::sample_2d(static_cast<std::uint32_t>(i), 7u));
            const vec3 dir = lamp.centre + disc.x * lamp.u + disc.y * lamp.v;
            const bool blocked = test::trace_exact(dag, {dvec3(start.cell) + dvec3(start.frac),
                                                         dvec3(dir), 0.0, lamp.t_end})
                                     .found;
            different += seen == blocked;
            ++(seen ? lit : dark);
        }
    }
    EXPECT_LE(different, 2);
    EXPECT_GT(lit, 200);
    EXPECT_GT(dark, 200);
}

/// A light of this kind that may be seen from about `at`, with what is random made so.
Light some_light(Light::Kind kind, const dvec3& at, test::RandomRays& random) {
    Light light;
    light.kind = kind;
    light.position = at + 60.0 * random.direction();
    light.direction =
        kind == Light::Kind::sun ? random.direction() : glm::normalize(at - light.position);
    light.size = random.uniform(0, 1) < 0.2 ? 0.0 : random.uniform(0, 0.2);
    if (kind != Light::Kind::sun) light.size *= 60.0;
    const dvec3 across = glm::normalize(glm::cross(light.direction, random.direction()));
    light.half_u = random.uniform(1, 9) * across;
    light.half_v = random.uniform(1, 9) * glm::cross(across, light.direction);
    for (int i = 0; i < 20; ++i) {
        const dvec3 corner = light.position + 8.0 * random.direction();
        light.triangles.push_back(
            {corner, corner + 4.0 * random.direction(), corner + 4.0 * random.direction()});
    }
    return light;
}

TEST(Shadow, IntervalOfALampsBundleChangesNoRay) {
    const Dag dags[] = {test::dust(8, 0.45, 3), test::slanted_wall(8, {3, -5, 7}, 300)};
    Partitions partitions[] = {Partitions(dags[0], 4), Partitions(dags[1], 4)};
    for (Partitions& some : partitions) some.make_all();
    const Grid grid{dvec3(0), 1.0, 8};
    test::RandomRays random(12, 256);
    int untraced = 0;
    int cut = 0;
    int rays = 0;
    for (int k = 0; k < 2400; ++k) {
        const Dag& dag = dags[k % 2];
        const s::DagView view = s::view(dag);
        const Ray at = random(test::RandomRays::inside);
        const s::GridRay eye{ivec3(at.origin), vec3(at.origin - glm::floor(at.origin)),
                             vec3(at.direction), 0.0f, 1e30f};
        const s::GridHit hit = trace_closest(view, eye, kToVoxels);
        const bool on_face = hit.face < s::kFaceInside;
        const s::GridRay start = on_face ? leave_hit(eye, hit, vec3(0, 0, 1)) : eye;
        const int face = on_face ? hit.face : s::kFaceNone;
        const auto kind = static_cast<Light::Kind>(k / 2 % 6);
        const Lamp lamp(some_light(kind, dvec3(start.cell), random), grid);
        const SeenLamp seen(lamp, start, face, vec3(random.direction()), k % 7 == 0);
        if (seen.dark()) continue;
        s::Bundle bundle = seen.bundle();
        const float t_end = bundle.t_max;
        const float first = bundle.t_min = beam_start(view, bundle, kToVoxels);
        const float last = first < t_end ? beam_end(view, bundle, kToVoxels) : first;
        untraced += !(first < last);
        cut += first > 0.0f || last < t_end;
        float brute = 0.0f;
        for (int i = 0; i < 64; ++i) {
            auto [ray, light] = seen.ray(i, 5u);
            if (!(light > 0.0f)) continue;
            ++rays;
            const s::GridHit whole = trace_closest(view, ray, kToVoxels);
            if (whole.face == s::kFaceNone) brute += light;
            ray.t_min = first;
            ray.t_max = last;
            const s::GridHit part = trace_closest(view, ray, kToVoxels);
            ASSERT_EQ(whole.face != s::kFaceNone, part.face != s::kFaceNone) << k << " " << i;
            if (whole.face != s::kFaceNone) {
                ASSERT_EQ(whole.path, part.path) << k << " " << i;
            }
        }
        RayQueue queue(dag, kToVoxels, &partitions[k % 2]);
        queue.begin_group();
        queue_lamp_rays(seen, 0, 64, 5u, queue);
        queue.trace();
        ASSERT_EQ(queue.seen(0), brute) << k;
    }
    EXPECT_GT(rays, 40000);
    EXPECT_GT(untraced, 50);
    EXPECT_GT(cut, 400);
}

}  // namespace
}  // namespace octavo
