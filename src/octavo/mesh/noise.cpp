// SPDX-License-Identifier: MIT
//
// Ken Perlin, "Improving Noise", SIGGRAPH 2002. A hash takes the place of the permutation table.
#include "octavo/mesh/noise.h"

#include <cmath>

namespace octavo {
namespace {

std::uint32_t hash(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
    std::uint32_t h = seed * 0x9e3779b1u + static_cast<std::uint32_t>(x) * 0x85ebca77u +
                      static_cast<std::uint32_t>(y) * 0xc2b2ae3du +
                      static_cast<std::uint32_t>(z) * 0x27d4eb2fu;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return h ^ h >> 15;
}

/// The dot product with one of the twelve directions to the edges of a cube.
double slope(std::uint32_t h, double x, double y, double z) {
    const std::uint32_t edge = (h >> 8) % 12;
    const double u = edge < 8 ? x : y;
    const double v = edge < 4 ? y : z;
    return ((h & 1) ? -u : u) + ((h & 2) ? -v : v);
}

double fade(double t) {
    return t * t * t * (t * (t * 6 - 15) + 10);
}
double mix(double a, double b, double t) {
    return a + (b - a) * t;
}

}  // namespace

double noise(const dvec3& p, std::uint32_t seed) {
    const dvec3 floor = glm::floor(p);
    const auto x = static_cast<std::int32_t>(floor.x), y = static_cast<std::int32_t>(floor.y),
               z = static_cast<std::int32_t>(floor.z);
    const dvec3 f = p - floor;
    const double u = fade(f.x), v = fade(f.y), w = fade(f.z);
    const auto corner = [&](int i, int j, int k) {
        return slope(hash(x + i, y + j, z + k, seed), f.x - i, f.y - j, f.z - k);
    };
    return mix(
        mix(mix(corner(0, 0, 0), corner(1, 0, 0), u), mix(corner(0, 1, 0), corner(1, 1, 0), u), v),
        mix(mix(corner(0, 0, 1), corner(1, 0, 1), u), mix(corner(0, 1, 1), corner(1, 1, 1), u), v),
        w);
}

double fractal_noise(dvec3 p, int octaves, std::uint32_t seed) {
    double sum = 0.0, strength = 1.0;
    for (int i = 0; i < octaves; ++i) {
        sum += strength * noise(p, seed + static_cast<std::uint32_t>(i));
        strength *= 0.5;
        p = p * 2.0 + 0.37;  // the shift keeps the octaves' zeros apart
    }
    return sum;
}

}  // namespace octavo
