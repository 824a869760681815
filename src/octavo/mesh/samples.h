// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "octavo/mesh/scene.h"

namespace octavo {

/// A scene that is made by code.
struct SampleInfo {
    std::string_view name;
    std::string_view description;  // one line
    std::size_t triangles;         // at size 1, rounded
};

/// The built-in scenes; the first one is the default.
[[nodiscard]] std::span<const SampleInfo> samples();

/// Makes a built-in scene, the same bits on every machine. Each has a sun and at least one camera;
/// y is up and a unit is a metre (for `hairball` and `scan`, the ball's radius is about 1).
///
/// @param size  multiplies the number of triangles, roughly; 0.0001 to 100
/// @throws Error  bad_argument for an unknown name or a size outside of that
[[nodiscard]] Scene make_sample(std::string_view name, double size = 1.0);

}  // namespace octavo
