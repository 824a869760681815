// SPDX-License-Identifier: MIT
#include "octavo/light/normal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/random_rays.h"
#include "support/small_dags.h"

namespace octavo {
namespace {

namespace s = shared;

TEST(SmoothNormal, IsThatOfASlantedPlaneOnBothItsSides) {
    for (const ivec3& a : {ivec3(3, -5, 7), ivec3(1, 9, 2), ivec3(0, 4, 1), ivec3(1, 1, 1)}) {
        const Dag dag = test::slanted_wall(8, a, (a.x + a.y + a.z) * 128);
        const vec3 plane = glm::normalize(vec3(a));
        test::RandomRays random(5, 256);
        double worst = 0.0;
        double sum = 0.0;
        int hits = 0;
        for (int i = 0; i < 4000; ++i) {
            const s::GridRay ray = test::grid_ray(random(test::RandomRays::outside));
            const s::GridHit hit = trace_closest(s::view(dag), ray, {0, 0.0f, 0.0f});
            // Away from the border of the grid, where the neighbourhood is whole, and not edge-on.
            if (hit.face >= s::kFaceInside || std::abs(glm::dot(ray.dir, plane)) < 0.2f) continue;
            if (glm::any(glm::lessThan(hit.path, uvec3(8))) ||
                glm::any(glm::greaterThan(hit.path, uvec3(247))))
                continue;
            const vec3 expected = glm::dot(ray.dir, plane) < 0.0f ? plane : -plane;
            const float cosine = glm::dot(smooth_normal(s::view(dag), ray, hit), expected);
            const double degrees = std::acos(std::min(cosine, 1.0f)) * 57.2958;
            worst = std::max(worst, degrees);
            sum += degrees;
            ++hits;
        }
        ASSERT_GT(hits, 300);
        EXPECT_LT(worst, 8.0);
        EXPECT_LT(sum / hits, 3.5);
    }
}

TEST(SmoothNormal, OfAThinFlatWallIsItsFace) {
    const Dag dag = test::dag_of(
        6, [](const uvec3&, std::uint32_t) { return true; },
        [](const uvec3& v) { return v.z == 30; });
    for (const double sign : {-1.0, 1.0}) {
        const s::GridRay ray = test::grid_ray({{20.3, 25.6, 30 - 20 * sign}, {0.1, 0.2, sign}});
        const s::GridHit hit = trace_closest(s::view(dag), ray, {0, 0.0f, 0.0f});
        EXPECT_EQ(smooth_normal(s::view(dag), ray, hit), vec3(0, 0, -sign));
        EXPECT_EQ(face_normal(ray, hit), vec3(0, 0, -sign));
    }
}

TEST(SmoothNormal, LooksOutOfASphereAtEveryLevel) {
    const dvec3 centre(128.3, 127.1, 128.8);
    const Dag dag =
        test::dag_of_distance(8, [&](const dvec3& p) { return glm::length(p - centre) - 100.0; });
    test::RandomRays random(5, 256);
    for (int i = 0; i < 3000; ++i) {
        const s::GridRay ray = test::grid_ray(random(test::RandomRays::outside));
        const int height = i % 3;
        const s::GridHit hit = trace_closest(s::view(dag), ray, {height, 0.0f, 0.0f});
        if (hit.face >= s::kFaceInside) continue;
        const dvec3 at = (dvec3(hit.path) + 0.5) * std::exp2(height);
        const dvec3 out = glm::normalize(at - centre);
        EXPECT_GT(glm::dot(out, dvec3(smooth_normal(s::view(dag), ray, hit))), 0.96);
    }
}

TEST(SmoothNormal, HasTheBitsOfTheSharedText) {
    const dvec3 centre(30.3, 33.1, 31.8);
    const Dag dags[] = {
        test::slanted_wall(6, ivec3(3, -5, 7), 160),
        test::dag_of_distance(6, [&](const dvec3& p) { return glm::length(p - centre) - 20.0; }),
        test::dag_of(  // specks: surfaces that nothing is smooth about
            6, [](const uvec3&, std::uint32_t) { return true; },
            [](const uvec3& v) { return s::mix_bits(v.x + s::mix_bits(v.y + 64 * v.z)) % 8 == 0; }),
    };
    for (const Dag& dag : dags) {
        test::RandomRays random(11, 64);
        int hits = 0;
        for (int i = 0; i < 2000; ++i) {
            const s::GridRay ray = test::grid_ray(random(test::RandomRays::outside));
            const s::GridHit hit = trace_closest(s::view(dag), ray, {i % 4, 0.0f, 0.0f});
            if (hit.face == s::kFaceNone) continue;
            EXPECT_EQ(smooth_normal(s::view(dag), ray, hit),
                      smooth_normal_32(s::view(dag), ray, hit));
            ++hits;
        }
        EXPECT_GT(hits, 500);
    }
}

}  // namespace
}  // namespace octavo
