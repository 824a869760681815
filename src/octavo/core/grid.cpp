// SPDX-License-Identifier: MIT
#include "octavo/core/grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "octavo/core/error.h"

namespace octavo {

Grid smallest_cube(const Box& bounds, int depth) {
    if (depth < kMinDepth || depth > kMaxDepth)
        throw Error(Errc::bad_argument, "depth " + std::to_string(depth) + " is not in 2 to 17");
    if (bounds.empty()) throw Error(Errc::bad_argument, "a grid needs bounds that are not empty");

    const dvec3 size = bounds.size();
    double side = std::max({size.x, size.y, size.z});
    if (!std::isfinite(side)) throw Error(Errc::bad_argument, "the scene's bounds are not finite");
    if (side == 0.0) side = 1.0;

    Grid grid;
    grid.depth = depth;
    grid.voxel_size = side / grid.resolution();
    grid.origin = bounds.centre() - 0.5 * side;
    return grid;
}

void check_grid(const Grid& grid) {
    if (!(grid.voxel_size > 0.0) || !std::isfinite(grid.voxel_size))
        throw Error(Errc::bad_argument, "a voxel's size is not above 0");
    const Box box = grid.bounds();
    double farthest = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {box.low[axis], box.high[axis]}) {
            if (!std::isfinite(side))
                throw Error(Errc::bad_argument, "the grid reaches past the largest number");
            farthest = std::max(farthest, std::abs(side));
        }
    // Half of a voxel must still change a coordinate.
    if (grid.voxel_size < 4.0 * std::numeric_limits<double>::epsilon() * farthest)
        throw Error(Errc::bad_argument,
                    "voxels are too small for places so far from the origin: their sides are lost "
                    "in the rounding of coordinates");
}

int depth_of_resolution(std::uint64_t resolution) {
    constexpr std::uint64_t kMin = 1ull << kMinDepth;
    constexpr std::uint64_t kMax = 1ull << kMaxDepth;
    if (!std::has_single_bit(resolution) || resolution < kMin || resolution > kMax)
        throw Error(Errc::bad_argument, "resolution " + std::to_string(resolution) +
                                            " is not a power of two from 4 to 131072");
    return std::countr_zero(resolution);
}

}  // namespace octavo
