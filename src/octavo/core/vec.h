// SPDX-License-Identifier: MIT
#pragma once

#include <glm/glm.hpp>

/// Vectors and matrices under GLSL's names, so that one text of the ray code serves all languages.
namespace octavo {

using glm::dmat4;
using glm::dvec3;
using glm::dvec4;
using glm::ivec2;
using glm::ivec3;
using glm::uvec2;
using glm::uvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;

}  // namespace octavo
