// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "octavo/mesh/scene.h"

namespace octavo {

/// What a triangle looks like that has no material, or one whose definition is missing: clay, which
/// render takes where a scene has no attributes. White where corners have colours, as these
/// multiply it. A material of a file that names no colour is white, as glTF has it.
[[nodiscard]] const Material& plain_material(bool corners_have_colors);

/// The material of a triangle, or plain_material().
[[nodiscard]] const Material& material_of(const Scene& scene, std::size_t triangle);

/// The decoded texture with this index, or nothing.
[[nodiscard]] const Texture* decoded_texture(const Scene& scene, int texture);

/// The alpha, as a byte of its texture, from which a place of this triangle is no hole: 0 where it
/// has none, 256 where it is nothing but hole. Alpha is that of the material times that of the
/// corners, of which the greatest counts, times that of the texture.
[[nodiscard]] int least_alpha(const Scene& scene, std::size_t triangle);
/// The same by the material and the greatest alpha of the corners.
[[nodiscard]] int least_alpha(const Material& material, std::uint8_t corner_alpha);

}  // namespace octavo
