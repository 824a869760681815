// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
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

/// A picture that a scene file refers to, or has within it under a name of its own.
struct PictureReference {
    std::string_view name;  // empty: none
    std::span<const std::byte> encoded = {};
};

/// Adds such a picture, once, and does not decode it.
///
/// @return  its index, or Material::kNoTexture, with a warning unless there is none
int add_texture(Scene& scene, const std::filesystem::path& folder,
                const PictureReference& reference);

}  // namespace octavo
