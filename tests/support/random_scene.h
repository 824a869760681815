// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <random>

#include "octavo/mesh/scene.h"

namespace octavo::test {

/// Triangles of every size and direction in the unit cube: slivers, faces of the grid, points and
/// segments among them. The same seed gives the same scene.
inline Scene random_scene(std::uint64_t seed, int triangle_count) {
    std::mt19937_64 bits(seed);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
    };
    const auto point = [&] { return dvec3(uniform(0, 1), uniform(0, 1), uniform(0, 1)); };
    const auto near = [&](const dvec3& p, double reach) {
        return glm::clamp(p + reach * (2.0 * point() - 1.0), dvec3(0.0), dvec3(1.0));
    };
    // Multiples of 1/64 lie on voxel faces at every resolution from 64 up.
    const auto snap = [](const dvec3& p) { return glm::round(p * 64.0) / 64.0; };

    Scene scene;
    const auto add = [&](const dvec3& a, const dvec3& b, const dvec3& c) {
        const auto first = static_cast<std::uint32_t>(scene.positions.size());
        scene.positions.insert(scene.positions.end(), {a, b, c});
        scene.triangles.emplace_back(first, first + 1, first + 2);
    };
    add({0, 0, 0}, {1, 1, 1}, {1, 0, 0});  // fixes the bounds
    for (int i = 1; i < triangle_count; ++i) {
        const dvec3 a = point();
        switch (bits() % 8) {
            case 0: add(a, point(), point()); break;
            case 1: add(a, near(a, 0.2), near(a, 0.2)); break;
            case 2: add(a, near(a, 0.01), near(a, 0.01)); break;
            case 3: add(snap(a), snap(point()), snap(point())); break;
            case 4: {  // in a face of the grid
                const dvec3 s = snap(a);
                dvec3 b = snap(point()), c = snap(point());
                const int axis = static_cast<int>(bits() % 3);
                b[axis] = c[axis] = s[axis];
                add(s, b, c);
                break;
            }
            case 5: {  // a sliver
                const dvec3 b = point();
                add(a, b, near(b, 0.0005));
                break;
            }
            case 6: {  // a segment
                const dvec3 s = snap(a), e = snap(point());
                add(s, e, 0.5 * (s + e));
                break;
            }
            default: add(a, a, a); break;
        }
    }
    return scene;
}

}  // namespace octavo::test
