// SPDX-License-Identifier: MIT
#include "octavo/core/grid.h"

#include <gtest/gtest.h>

#include "octavo/core/error.h"

namespace octavo {
namespace {

TEST(Grid, SmallestCubeHoldsTheBoundsAndIsCentredOnThem) {
    const Box bounds{{-1, 2, 5}, {3, 3, 5.5}};
    const Grid grid = smallest_cube(bounds, 10);
    EXPECT_DOUBLE_EQ(grid.side(), 4.0);
    EXPECT_EQ(grid.bounds().centre(), bounds.centre());
    EXPECT_EQ(grid.resolution(), 1024u);
}

TEST(Grid, ASinglePointGetsACubeOfSideOne) {
    const Grid grid = smallest_cube({dvec3(7), dvec3(7)}, 4);
    EXPECT_DOUBLE_EQ(grid.side(), 1.0);
    EXPECT_EQ(grid.bounds().centre(), dvec3(7));
}

TEST(Grid, WorldAndGridSpaceAreInverse) {
    const Grid grid{{5.7e6, -4.1e6, 12.5}, 0.125, 17};
    const dvec3 voxel(131071.5, 0.25, 77.0);
    const dvec3 back = grid.to_grid(grid.to_world(voxel));
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(back[axis], voxel[axis], 1e-8);
}

TEST(Grid, RefusesBoundsThatAreEmptyOrNotFinite) {
    EXPECT_THROW((void)smallest_cube(Box(), 5), Error);
    EXPECT_THROW((void)smallest_cube({dvec3(0), dvec3(INFINITY)}, 5), Error);
    EXPECT_THROW((void)smallest_cube({dvec3(0), dvec3(1)}, 18), Error);
}

TEST(Grid, ThatSomebodyChoseIsFiniteAndItsVoxelsCanBeToldApart) {
    for (const auto& [origin, voxel] : {std::pair(0.0, 1e308),
                                        {0.0, 0.0},
                                        {0.0, -1.0},
                                        {0.0, double(NAN)},
                                        {0.0, double(INFINITY)},
                                        {double(NAN), 1.0},
                                        {1e308, 1.0},
                                        {-1e308, 1.0},
                                        {1e16, 1.0}})
        EXPECT_THROW(check_grid({dvec3(0, origin, 0), voxel, 10}), Error) << origin << " " << voxel;
    for (const auto& [origin, voxel] :
         {std::pair(0.0, 1e-300), {0.0, 1e300}, {5.7e6, 0.01}, {1e12, 0.01}})
        EXPECT_NO_THROW(check_grid({dvec3(origin), voxel, 17})) << origin << " " << voxel;
}

TEST(Grid, AResolutionIsAPowerOfTwoFrom4To131072) {
    EXPECT_EQ(depth_of_resolution(4), 2);
    EXPECT_EQ(depth_of_resolution(131072), 17);
    for (const std::uint64_t wrong : {0ull, 1ull, 2ull, 3ull, 1000ull, 262144ull, 1ull << 63})
        EXPECT_THROW((void)depth_of_resolution(wrong), Error) << wrong;
}

}  // namespace
}  // namespace octavo
