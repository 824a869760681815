// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string_view>

#include "octavo/mesh/scene.h"

namespace octavo {

/// Adds a texture with the colours of one picture and the alpha of another, as MTL has them: the
/// mask's own alpha or, where that is 255 everywhere, its brightness. Both are decoded here and
/// kept as one encoded picture, as large as the larger of them; the same pair is added once.
///
/// @param color_reference  of the scene file; empty: white
/// @return  its index, or Material::kNoTexture and a warning where the mask is missing, damaged or
///          outside the folder; colours that are get a warning, and are white
int add_masked_texture(Scene& scene, const std::filesystem::path& folder,
                       std::string_view color_reference, std::string_view mask_reference);

}  // namespace octavo
