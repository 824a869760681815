// SPDX-License-Identifier: MIT
#include "octavo/light/light_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace octavo {
namespace {

std::vector<Light> lamps_in(const Box& box, int count, float intensity) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<Light> lights;
    for (int i = 0; i < count; ++i) {
        Light light;
        light.kind = Light::Kind::point;
        light.position = box.low + box.size() * dvec3(unit(random), unit(random), unit(random));
        light.intensity = vec3(intensity);
        lights.push_back(light);
    }
    return lights;
}

TEST(LightGrid, ListsOfManyLightsThatReachEverythingStayShort) {
    // 98 304 lists of 30 000 lights would take 3 GB.
    const Box box{dvec3(-10.0), dvec3(10.0)};
    const std::vector<Light> suns(30000);
    const LightGrid grid(suns, box, dvec3(0.0));
    EXPECT_EQ(grid.near(dvec3(1.0)).size(), suns.size());
}

TEST(LightGrid, ListsEveryLightThatReachesThePoint) {
    const Box box{dvec3(-10.0), dvec3(30.0, 10.0, 20.0)};
    std::vector<Light> lights = lamps_in(box, 300, 0.002f);
    lights.push_back({});  // a sun
    const dvec3 centre(3.0, 2.0, 1.0);
    const LightGrid grid(lights, box, centre);
    std::mt19937 random(3);
    std::normal_distribution<double> spread(0.0, 8.0);
    for (int i = 0; i < 500; ++i) {
        const dvec3 point = centre + dvec3(spread(random), spread(random), spread(random));
        const auto listed = grid.near(point);
        EXPECT_TRUE(std::ranges::is_sorted(listed));
        for (std::uint32_t n = 0; n < lights.size(); ++n) {
            const bool reached =
                lights[n].kind == Light::Kind::sun || glm::length(lights[n].position - point) <=
                                                          light_reach(lights[n], LightGrid::kLeast);
            EXPECT_TRUE(!reached || std::ranges::binary_search(listed, n)) << i << " " << n;
        }
    }
}

TEST(LightGrid, ListsFewOfManyLightsThatReachNotFar) {
    const Box box{dvec3(0.0), dvec3(100.0)};
    const std::vector<Light> lights = lamps_in(box, 500, 0.01f);
    const LightGrid grid(lights, box, dvec3(50.0));
    std::size_t listed = 0;
    for (int i = 0; i < 100; ++i) listed += grid.near(dvec3(i, 50.0, 50.0)).size();
    EXPECT_LT(listed, 100 * 10u);
}

TEST(LightReach, IsWhereAWhiteSurfaceFallsBelowTheLeast) {
    Light light;
    light.kind = Light::Kind::point;
    light.intensity = vec3(1.0f, 4.0f, 2.0f);
    const double reach = light_reach(light, 0.01f);
    EXPECT_NEAR(4.0 / (3.14159265 * reach * reach), 0.01, 1e-6);
}

}  // namespace
}  // namespace octavo
