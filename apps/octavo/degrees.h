// SPDX-License-Identifier: MIT
#pragma once

#include <numbers>

namespace octavo::cli {

/// Users and their files write angles in degrees.
inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

/// Of a camera that is not told another vertical field of view.
inline constexpr double kDefaultFovDegrees = 45.0;

}  // namespace octavo::cli
