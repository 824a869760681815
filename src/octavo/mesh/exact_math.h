// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>

#include "octavo/core/vec.h"

/// Functions for the built-in scenes that give the same bits on every machine: they use only what
/// IEEE 754 rounds exactly, where the C library's sine may differ by processor.
namespace octavo::exact {

inline constexpr double kPi = 3.14159265358979323846;

namespace detail {
/// Sine and cosine for angles of at most pi / 4, by their series.
inline double sine_series(double x) {
    const double s = x * x;
    return x * (1 - s / 6 * (1 - s / 20 * (1 - s / 42 * (1 - s / 72 * (1 - s / 110)))));
}
inline double cosine_series(double x) {
    const double s = x * x;
    return 1 - s / 2 * (1 - s / 12 * (1 - s / 30 * (1 - s / 56 * (1 - s / 90 * (1 - s / 132)))));
}
}  // namespace detail

/// Of an angle in radians; the error stays below 1e-11 for angles up to 1e4.
inline double sine(double angle) {
    const double quarters = std::floor(angle * (2 / kPi) + 0.5);
    const double x = angle - quarters * (kPi / 2);
    switch (static_cast<std::int64_t>(quarters) & 3) {
        case 0:
            return detail::sine_series(x);
        case 1:
            return detail::cosine_series(x);
        case 2:
            return -detail::sine_series(x);
        default:
            return -detail::cosine_series(x);
    }
}
inline double cosine(double angle) {
    return sine(angle + kPi / 2);
}

/// The nearest floats. Not inline: where g++ 12 sees both conversions of double to float to double,
/// its vectorizer drops them (-O2, x and y of a vector) and nothing is rounded.
[[nodiscard]] vec3 to_floats(const dvec3& p);
[[nodiscard]] inline dvec3 rounded_to_float(const dvec3& p) {
    return dvec3(to_floats(p));
}

/// Smooth from 0 at `low` to 1 at `high`.
inline double smooth_step(double low, double high, double x) {
    const double t = glm::clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

}  // namespace octavo::exact
