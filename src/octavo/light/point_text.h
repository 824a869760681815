// SPDX-License-Identifier: MIT
#pragma once

/// What the shared text says of one point, for C++: its surface, and the light that reaches it.
#include "octavo/trace/dag_view.h"

#include "octavo/light/sampling.h"

#include "octavo/light/shade.h"
#include "octavo/light/shadow.h"
#include "octavo/light/surface.h"

#include "octavo/light/lamp_triangle.h"

namespace octavo::shared {

OCTAVO_ARRAY(LampTriangles, LampTriangle)
OCTAVO_FN LampTriangle lamp_triangle(LampTriangles triangles, int number) {
    return triangles.at[number];
}

}  // namespace octavo::shared

#include "octavo/light/lamp_light.h"
#include "octavo/light/smooth_normal.h"
