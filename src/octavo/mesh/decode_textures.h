// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

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

/// The picture of the scene's texture with this index, decoded now if it is not yet, and then not
/// kept in the scene. None where it cannot be read, and `warning` says why.
[[nodiscard]] std::shared_ptr<const Bitmap> decoded_picture(const Scene& scene, int texture,
                                                            std::string& warning);

}  // namespace octavo
