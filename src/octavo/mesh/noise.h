// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "octavo/core/vec.h"

namespace octavo {

/// Gradient noise (Perlin 2002) over an integer hash: smooth, zero at whole coordinates, within
/// about -1 to 1, the same on every machine.
[[nodiscard]] double noise(const dvec3& p, std::uint32_t seed);

/// Octaves of noise, each twice as fine and half as strong as the one before; within about -2 to 2.
[[nodiscard]] double fractal_noise(dvec3 p, int octaves, std::uint32_t seed);

}  // namespace octavo
