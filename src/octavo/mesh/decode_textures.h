// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/mesh/scene.h"

namespace octavo {

enum class WantedTextures {
    cut_outs,  // those whose alpha makes holes in surfaces: what the voxels depend on
    all,       // these, and all others of base colours and emission
};

/// Decodes the pictures that the scene's materials use, in parallel; without it surfaces have the
/// colours of their factors, and no holes. A picture that cannot be read becomes a warning with its
/// name, and is done without. What is decoded already is kept.
///
/// Memory: 4 bytes for each pixel.
void decode_textures(Scene& scene, WantedTextures wanted);

}  // namespace octavo
