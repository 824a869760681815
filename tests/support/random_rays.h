// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <random>

#include "octavo/trace/grid_ray.h"
#include "octavo/trace/trace.h"

namespace octavo::test {

/// The ray in 32 bits, as the shared text takes it.
inline shared::GridRay grid_ray(const Ray& ray) {
    return octavo::grid_ray(ray.origin, vec3(ray.direction), 1e9f);
}

/// Random rays for a grid of this many voxels: from inside, from outside, along axes, along edges
/// and planes between voxels, exact diagonals, from lattice point to lattice point. Every
/// coordinate is one that a float holds, so that no two traces of them start from different rays.
class RandomRays {
public:
    enum Kind { inside, outside, axis, edge, diagonal, lattice, kinds };

    RandomRays(std::uint32_t seed, int resolution) : random_(seed), size_(resolution) {}

    Ray operator()(Kind kind) {
        Ray ray;
        ray.origin = {uniform(0, size_), uniform(0, size_), uniform(0, size_)};
        ray.direction = direction();
        switch (kind) {
            case outside: {
                const dvec3 target = ray.origin;
                ray.origin = 0.5 * size_ + direction() * (size_ * uniform(1, 4));
                ray.direction = glm::normalize(target - ray.origin);
                break;
            }
            case axis:
            case edge: {
                ray.direction = dvec3(flip() ? 0.0 : -0.0);
                const int a = integer(0, 2);
                ray.direction[a] = flip() ? 1.0 : -1.0;
                if (kind == edge) ray.origin = glm::floor(ray.origin);
                if (flip()) ray.origin[a] = ray.direction[a] > 0 ? -5.0 : size_ + 5.0;
                if (kind == edge && flip()) {  // in a plane, but not along an edge
                    ray.direction[(a + 1) % 3] = uniform(-1, 1);
                    ray.origin[(a + 1) % 3] = uniform(0, size_);
                }
                break;
            }
            case diagonal:
                ray.direction = whole_direction(1);
                ray.origin = glm::floor(ray.origin) + (flip() ? 0.5 : 0.0);
                break;
            case lattice:
                ray.direction = whole_direction(9);
                ray.origin = glm::floor(ray.origin);
                break;
            default:
                break;
        }
        ray.origin = dvec3(vec3(ray.origin));
        ray.direction = dvec3(vec3(ray.direction));
        return ray;
    }

    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    int integer(int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random_);
    }
    bool flip() { return integer(0, 1) == 1; }

    dvec3 direction() {
        dvec3 d;
        do d = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        while (glm::dot(d, d) > 1 || glm::dot(d, d) < 1e-3);
        return glm::normalize(d);
    }

private:
    dvec3 whole_direction(int most) {
        dvec3 d(0.0);
        while (d == dvec3(0.0))
            d = {integer(-most, most), integer(-most, most), integer(-most, most)};
        return d;
    }

    std::mt19937 random_;
    double size_;
};

}  // namespace octavo::test
