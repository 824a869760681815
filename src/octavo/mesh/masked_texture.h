// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "octavo/mesh/scene.h"
#include "octavo/mesh/texture_files.h"

namespace octavo {

/// Gives a material the colours of one picture and the holes of another: the mask's own alpha or,
/// where that is 255 everywhere, its brightness, with half as the cut-off. Where both are one
/// picture, its alpha counts. Two are decoded here and kept as one encoded picture, as large as the
/// larger of them; the same pair is added once. What is missing, damaged or outside the folder gets
/// a warning: a mask is then left out, colours are white.
void set_base_color_texture(Scene& scene, Material& material, const std::filesystem::path& folder,
                            const PictureReference& color, const PictureReference& mask);

}  // namespace octavo
