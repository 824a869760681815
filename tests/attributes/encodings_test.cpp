// SPDX-License-Identifier: MIT
#include "octavo/attributes/encodings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace octavo {
namespace {

TEST(Encodings, AnSrgbByteSurvivesLinearLight) {
    for (int i = 0; i < 256; ++i) {
        const float linear = linear_from_srgb8(static_cast<std::uint8_t>(i));
        EXPECT_EQ(srgb8_from_linear16(static_cast<std::uint32_t>(std::lround(linear * 65535.0f))),
                  i);
    }
    EXPECT_NEAR(linear_from_srgb8(188), 0.5029, 1e-4);  // from the curve of IEC 61966-2-1
}

TEST(Encodings, SharedExponentIsWithinAPartIn512OfTheLargest) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> exponent(-12.0f, 15.9f), part(0.0f, 1.0f);
    for (int i = 0; i < 100000; ++i) {
        const float scale = std::exp2(exponent(random));
        const vec3 c(scale * part(random), scale * part(random), scale * part(random));
        const vec3 got = unpack_rgb9e5(pack_rgb9e5(c));
        const float largest = std::max({c.r, c.g, c.b});
        for (int k = 0; k < 3; ++k) ASSERT_NEAR(got[k], c[k], largest / 512.0f) << i;
    }
    EXPECT_EQ(pack_rgb9e5(vec3(0.0f)), 0u);
    EXPECT_EQ(pack_rgb9e5(vec3(-1.0f, NAN, 0.0f)), 0u);
    EXPECT_EQ(unpack_rgb9e5(pack_rgb9e5(vec3(1e9f))), vec3(65408.0f));
    EXPECT_EQ(unpack_rgb9e5(pack_rgb9e5({1.0f, 0.5f, 0.25f})), vec3(1.0f, 0.5f, 0.25f));
}

TEST(Encodings, NormalsAreWithinATenthOfADegree) {
    std::mt19937 random(2);
    std::normal_distribution<float> normal;
    for (int i = 0; i < 100000; ++i) {
        const vec3 n = glm::normalize(vec3(normal(random), normal(random), normal(random)));
        ASSERT_GT(glm::dot(glm::dvec3(unpack_normal(pack_normal(n))), glm::dvec3(n)),
                  std::cos(0.1 * 3.14159265 / 180.0));
        ASSERT_LT(pack_coarse_direction(n), kCoarseDirections);
        ASSERT_GT(glm::dot(unpack_coarse_direction(pack_coarse_direction(n)), n), 0.90f);
    }
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.0f, 1.0f}) {
            vec3 n(0.0f);
            n[axis] = sign;
            EXPECT_NEAR(glm::length(unpack_normal(pack_normal(n)) - n), 0.0f, 1e-6f);
            EXPECT_NEAR(glm::length(unpack_coarse_direction(pack_coarse_direction(n)) - n), 0.0f,
                        1e-6f);
        }
}

}  // namespace
}  // namespace octavo
