// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string_view>

#include "octavo/mesh/scene.h"

namespace octavo {

/// Adds the picture that a scene file in this folder refers to; the same file, wrapped the same
/// way, is added once. The picture is not opened.
///
/// @return  its index, or Material::kNoTexture and a warning where it is missing or outside the
///          folder
int add_texture_file(Scene& scene, const std::filesystem::path& folder, std::string_view reference,
                     Texture::Wrap wrap_u = Texture::Wrap::repeat,
                     Texture::Wrap wrap_v = Texture::Wrap::repeat);

}  // namespace octavo
