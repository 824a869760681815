// SPDX-License-Identifier: MIT
#include "octavo/mesh/scene.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cmath>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace octavo {

Box Scene::bounds() const {
    const auto finite = [](const dvec3& p) {
        return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    };
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, triangles.size(), 1 << 14), Box{},
        [&](const tbb::blocked_range<std::size_t>& range, Box box) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const auto [a, b, c] = corners(i);
                if (!finite(a) || !finite(b) || !finite(c)) continue;
                box.extend(a);
                box.extend(b);
                box.extend(c);
            }
            return box;
        },
        [](Box a, const Box& b) {
            a.extend(b);
            return a;
        });
}

std::uint64_t Scene::geometry_hash() const {
    const std::uint64_t of_positions =
        XXH3_64bits(positions.data(), positions.size() * sizeof(positions[0]));
    return XXH3_64bits_withSeed(triangles.data(), triangles.size() * sizeof(triangles[0]),
                                of_positions);
}

}  // namespace octavo
