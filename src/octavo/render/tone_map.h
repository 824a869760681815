// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "octavo/core/vec.h"

namespace octavo {

/// From linear light to what a screen shows: 8-bit sRGB. Mid-tones stay as they are; from 0.6 on,
/// light bends towards white without reaching it, so that a bright wall keeps its shading.
///
/// @param scale  multiplies the light first: 2^exposure. Not a number is black.
[[nodiscard]] std::array<std::uint8_t, 3> tone_map(const vec3& linear, float scale);

}  // namespace octavo
