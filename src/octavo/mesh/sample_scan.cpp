// SPDX-License-Identifier: MIT
#include <tbb/parallel_for.h>

#include "octavo/mesh/noise.h"
#include "octavo/mesh/sample_scenes.h"
#include "octavo/mesh/shapes.h"

namespace octavo {
namespace {

constexpr double kTriangles = 10e6;

/// How far the stone's surface is from its middle in this direction.
double radius_at(const dvec3& d) {
    const double lumps = fractal_noise(1.3 * d, 3, 11);
    // Ridges: noise folded at zero, strongest where the stone bulges.
    const double ridges = 1.0 - std::abs(fractal_noise(2.6 * d, 3, 23));
    const double chips = fractal_noise(11.0 * d, 3, 37);
    return 0.78 + 0.20 * lumps + 0.16 * ridges * ridges * (0.6 + 0.4 * lumps) + 0.012 * chips;
}

}  // namespace

/// A sphere in six square patches, so that triangles are nearly of one size, as a scanner's are.
Scene scenes::scan(double size) {
    const auto n =
        static_cast<std::uint32_t>(std::max(2.0, std::round(std::sqrt(kTriangles * size / 12.0))));
    const std::size_t row = n + 1;
    Scene scene;
    scene.positions.resize(6 * row * row);
    scene.triangles.resize(std::size_t{12} * n * n);

    tbb::parallel_for(std::size_t{0}, 6 * row, [&](std::size_t line) {
        const int axis = static_cast<int>(line / row / 2);
        const double sign = line / row % 2 == 0 ? 1.0 : -1.0;
        const std::size_t j = line % row;
        // Equal angles, through the half angle's tangent, give nearly equal cells.
        const auto spread = [n](std::size_t i) {
            const double angle = exact::kPi / 2 * (static_cast<double>(i) / n - 0.5);
            return exact::sine(angle) / exact::cosine(angle);
        };
        for (std::size_t i = 0; i < row; ++i) {
            dvec3 d{0.0};
            d[axis] = sign;
            d[(axis + 1) % 3] = spread(i);
            d[(axis + 2) % 3] = spread(j) * sign;
            d = glm::normalize(d);
            // The scanner's own error, a fraction of a cell; continuous, so that patches still
            // meet.
            const double error = 0.25 / n * noise(0.4 * n * d, 91);
            scene.positions[line * row + i] = exact::rounded_to_float(d * (radius_at(d) + error));
        }
        if (j == n) return;
        uvec3* out = scene.triangles.data() + std::size_t{2} * n * (line - line / row);
        for (std::uint32_t i = 0; i < n; ++i) {
            const auto a = static_cast<std::uint32_t>(line * row + i);
            const auto b = static_cast<std::uint32_t>(a + row);
            *out++ = {a, a + 1, b + 1};
            *out++ = {a, b + 1, b};
        }
    });
    Material stone;
    stone.name = "stone";
    stone.base_color = {0.52f, 0.47f, 0.41f, 1.0f};
    scene.materials.push_back(stone);
    scene.triangle_materials.assign(scene.triangles.size(), 0);
    scene.cameras.push_back(look_at("front", {1.4, 0.9, 2.6}, {0.0, 0.0, 0.0}, 0.75));
    scene.lights.push_back(sun({-0.7, -0.6, -0.3}, vec3(3.0f)));
    return scene;
}

}  // namespace octavo
