// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/mesh/scene.h"

namespace octavo::test {

/// A white point lamp.
inline Light lamp_at(const dvec3& position, float intensity) {
    Light lamp;
    lamp.kind = Light::Kind::point;
    lamp.position = position;
    lamp.intensity = vec3(intensity);
    return lamp;
}

}  // namespace octavo::test
