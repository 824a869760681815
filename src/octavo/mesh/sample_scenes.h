// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/mesh/scene.h"

/// One function per built-in scene; `make_sample` chooses.
namespace octavo::scenes {

[[nodiscard]] Scene courtyard(double size);
[[nodiscard]] Scene hairball(double size);
[[nodiscard]] Scene scan(double size);
[[nodiscard]] Scene city(double size);

}  // namespace octavo::scenes
