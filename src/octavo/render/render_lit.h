// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/light/lit_scene.h"
#include "octavo/render/render.h"

namespace octavo {

/// Where the light of a picture comes from.
enum class Lighting {
    gathered,  // lamps by shadow rays; rays over the hemisphere read the light of the cells they
               // meet
    cached,    // the light of the cells alone, smoothed over them: no secondary ray but to the next
               // cells
    reference,  // paths through the voxels, without what is stored: next-event estimation, Russian
                // roulette. One for each primary ray
};

/// Renders a scene with the colours of its cells and all the light there is.
///
/// Of the options, `lights`, the ambient ones, `shadows` other than `hard` and the level of detail
/// have no meaning here: the scene has lights, and pictures have the voxels themselves.
/// `shadow_samples` are rays towards each lamp for each pixel; ambient ones, those over the
/// hemisphere, and a quarter as many towards bright sky and shining cells.
///
/// @param scene   lit by light_cells() but for Lighting::reference; an object without light sends
///                nothing back to others
/// @return        width * height pixels, see Image
/// @throws Error  bad_argument where an option is out of range, or where Lighting::cached finds an
///                object without light; cancelled
[[nodiscard]] Image render_lit(const LitScene& scene, Lighting lighting,
                               const RenderOptions& options);

}  // namespace octavo
