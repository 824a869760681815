// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "octavo/attributes/attributes.h"
#include "octavo/attributes/cell_light.h"
#include "octavo/core/grid.h"
#include "octavo/dag/dag.h"
#include "octavo/light/sky.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// Something that can be lit: a DAG with what its cells look like, and a place in the scene.
struct LitObject {
    std::string name = {};
    Dag dag;
    Grid grid;
    Attributes attributes = {};  // none: of clay, and without stored light
    dmat4 placement{1.0};        // from its own space to the scene's; affine, with an inverse
    CellLight light = {};        // of light_cells(); none: not lit yet
};

/// What light_cells() and render_lit() work on. The first object is the static scene; its space is
/// the scene's.
struct LitScene {
    std::vector<LitObject> objects;
    std::vector<Light> lights;  // the scene's space. Emissive cells shine by themselves: a lamp
                                // made of their triangles must not be here as well
    Sky sky;
};

}  // namespace octavo
