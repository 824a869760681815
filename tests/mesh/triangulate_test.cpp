// SPDX-License-Identifier: MIT
#include "octavo/mesh/triangulate.h"

#include <gtest/gtest.h>

#include <numeric>

namespace octavo {
namespace {

double area(const std::vector<dvec3>& points, const std::vector<uvec3>& triangles) {
    double sum = 0.0;
    for (const uvec3& t : triangles)
        sum += 0.5 * glm::length(glm::cross(points[t.y] - points[t.x], points[t.z] - points[t.x]));
    return sum;
}

std::vector<uvec3> triangles_of(const std::vector<dvec3>& points) {
    std::vector<std::uint32_t> corners(points.size());
    std::iota(corners.begin(), corners.end(), 0u);
    std::vector<uvec3> triangles;
    triangulate(points, corners, triangles);
    return triangles;
}

TEST(Triangulate, CoversAConcavePolygonOnce) {
    // An L of area 3; a fan around its first corner would have area 4.
    const std::vector<dvec3> l{{2, 0, 5}, {2, 1, 5}, {1, 1, 5}, {1, 2, 5}, {0, 2, 5}, {0, 0, 5}};
    EXPECT_EQ(triangles_of(l).size(), 4u);
    EXPECT_NEAR(area(l, triangles_of(l)), 3.0, 1e-12);
}

TEST(Triangulate, CutsADartQuadOnTheRightSide) {
    const std::vector<dvec3> dart{{0, 0, 0}, {0, 4, 1}, {0, 0, 4}, {0, 1, 1}};
    EXPECT_NEAR(area(dart, triangles_of(dart)), 6.0, 1e-12);
}

TEST(Triangulate, GivesTwoTrianglesFewerThanCornersWhateverTheShape) {
    for (const std::size_t corners : {3, 4, 7, 64, 300}) {
        std::vector<dvec3> points;
        for (std::size_t i = 0; i < corners; ++i)  // a tangle that crosses itself
            points.emplace_back((i * 7919) % 101, (i * 104729) % 97, 0.0);
        EXPECT_EQ(triangles_of(points).size(), corners - 2);
    }
    EXPECT_TRUE(triangles_of({{0, 0, 0}, {1, 0, 0}}).empty());
}

TEST(Triangulate, KeepsTheDetailOfFarCoordinates) {
    std::vector<dvec3> l{{2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 0, 0}};
    for (dvec3& p : l) p = 0.01 * p + dvec3(5.7e6, 4.2e6, 100.0);
    EXPECT_NEAR(area(l, triangles_of(l)), 3e-4, 1e-9);
}

}  // namespace
}  // namespace octavo
