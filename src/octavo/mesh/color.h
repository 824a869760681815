// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace octavo {

using Rgba8 = std::array<std::uint8_t, 4>;

inline constexpr Rgba8 kWhite{255, 255, 255, 255};

/// A number from 0 to 1 as a byte, rounded; what is outside is clamped, and NaN is 0.
[[nodiscard]] inline std::uint8_t unit_to_byte(double value) {
    if (!(value > 0.0)) return 0;
    return value < 1.0 ? static_cast<std::uint8_t>(std::lround(value * 255.0)) : 255;
}

}  // namespace octavo
