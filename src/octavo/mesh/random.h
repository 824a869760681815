// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>

#include "octavo/core/vec.h"

namespace octavo {

/// Random numbers that are the same on every machine; std's distributions are not. The generator is
/// splitmix64 (Steele, Lea, Flood 2014).
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t next() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        return z ^ z >> 31;
    }
    /// From 0, below 1.
    double real() { return static_cast<double>(next() >> 11) * 0x1p-53; }
    double between(double low, double high) { return low + (high - low) * real(); }
    /// From 0, below count.
    int below(int count) { return static_cast<int>(real() * count); }
    bool chance(double probability) { return real() < probability; }

    /// A unit vector, every direction alike.
    dvec3 direction() {
        for (;;) {
            const dvec3 p(between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0));
            const double square = glm::dot(p, p);
            if (square > 0.01 && square <= 1.0) return p / std::sqrt(square);
        }
    }

private:
    std::uint64_t state_;
};

}  // namespace octavo
