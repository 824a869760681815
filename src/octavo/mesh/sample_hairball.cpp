// SPDX-License-Identifier: MIT
#include <tbb/parallel_for.h>

#include "octavo/mesh/random.h"
#include "octavo/mesh/sample_scenes.h"
#include "octavo/mesh/shapes.h"

namespace octavo {
namespace {

constexpr int kTubes = 5000;
constexpr int kSteps = 56;  // along a tube
constexpr int kSides = 5;
constexpr double kStep = 0.05;
constexpr double kRadius = 0.0035;
constexpr double kTurn = 7.0;  // radians per unit of length that a tube bends at most

/// Writes the tube's (kSteps + 1) * kSides points.
void grow_tube(std::uint64_t seed, dvec3* out) {
    Random random(seed);
    dvec3 p = 0.12 * random.direction();
    dvec3 forward = random.direction();
    dvec3 bend = random.direction(), next_bend = random.direction();
    dvec3 side = glm::normalize(glm::cross(forward, random.direction()));
    for (int step = 0; step <= kSteps; ++step) {
        // A frame that turns as little as the curve lets it.
        side = glm::normalize(side - forward * glm::dot(side, forward));
        const dvec3 other = glm::cross(forward, side);
        const double radius = kRadius * (1.0 - 0.6 * step / kSteps);
        for (int k = 0; k < kSides; ++k) {
            const double angle = 2 * exact::kPi * k / kSides;
            const dvec3 q = p + radius * (exact::cosine(angle) * side + exact::sine(angle) * other);
            *out++ = exact::rounded_to_float(q);
        }
        // Bends drift slowly, which makes curls, and turn inwards near the ball's surface.
        if (step % 14 == 13) {
            bend = next_bend;
            next_bend = random.direction();
        }
        const double t = (step % 14) / 14.0;
        dvec3 pull = kTurn * (bend * (1 - t) + next_bend * t);
        const double distance = glm::length(p);
        if (distance > 0.8) pull -= p * (60.0 * (distance - 0.8));
        forward = glm::normalize(forward + kStep * pull);
        p += kStep * forward;
    }
}

}  // namespace

Scene scenes::hairball(double size) {
    const auto tubes = static_cast<std::size_t>(std::max(1.0, std::round(kTubes * size)));
    constexpr std::size_t kPoints = std::size_t{kSteps + 1} * kSides;
    constexpr std::size_t kTriangles = std::size_t{2} * kSteps * kSides;

    Scene scene;
    scene.positions.resize(tubes * kPoints);
    scene.triangles.resize(tubes * kTriangles);
    tbb::parallel_for(std::size_t{0}, tubes, [&](std::size_t tube) {
        grow_tube(tube, scene.positions.data() + tube * kPoints);
        const auto base = static_cast<std::uint32_t>(tube * kPoints);
        uvec3* out = scene.triangles.data() + tube * kTriangles;
        for (std::uint32_t step = 0; step < kSteps; ++step) {
            for (std::uint32_t k = 0; k < kSides; ++k) {
                const std::uint32_t a = base + step * kSides + k;
                const std::uint32_t b = base + step * kSides + (k + 1) % kSides;
                *out++ = {a, b, b + kSides};
                *out++ = {a, b + kSides, a + kSides};
            }
        }
    });
    Material hair;
    hair.name = "hair";
    hair.base_color = {0.55f, 0.36f, 0.20f, 1.0f};
    scene.materials.push_back(hair);
    scene.triangle_materials.assign(scene.triangles.size(), 0);
    scene.cameras.push_back(look_at("front", {0.4, 0.5, 3.0}, {0.0, 0.0, 0.0}, 0.75));
    scene.lights.push_back(sun({-0.5, -0.8, -0.6}, vec3(3.0f)));
    return scene;
}

}  // namespace octavo
