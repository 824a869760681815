// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "octavo/core/vec.h"

/// How a colour, a radiance and a direction become the bits of a cell's value.
namespace octavo {

/// Red, green, blue; sRGB.
using Rgb8 = std::array<std::uint8_t, 3>;

/// IEC 61966-2-1: an 8-bit sRGB channel as linear light, 0 to 1.
[[nodiscard]] float linear_from_srgb8(std::uint8_t channel);
[[nodiscard]] inline vec3 linear_from_srgb8(const Rgb8& color) {
    return {linear_from_srgb8(color[0]), linear_from_srgb8(color[1]), linear_from_srgb8(color[2])};
}

/// The nearest 8-bit sRGB channel to linear light in steps of 1/65535.
[[nodiscard]] std::uint8_t srgb8_from_linear16(std::uint32_t linear);

/// The same for each of the 65536 steps.
[[nodiscard]] std::span<const std::uint8_t> srgb8_of_linear16();

/// A colour as the low 24 bits of a value: red lowest.
[[nodiscard]] constexpr std::uint32_t pack_rgb8(const Rgb8& c) {
    return c[0] | std::uint32_t{c[1]} << 8 | std::uint32_t{c[2]} << 16;
}
[[nodiscard]] constexpr Rgb8 unpack_rgb8(std::uint32_t value) {
    return {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8),
            static_cast<std::uint8_t>(value >> 16)};
}

/// Three floats of 9 bits with one exponent of 5: the RGB9E5 of OpenGL and Vulkan, 0 to 65408 with
/// an error of at most 1/512 of the largest. Negative and not finite numbers become 0 or the
/// greatest. Red is lowest, the exponent highest; 0 is black.
[[nodiscard]] std::uint32_t pack_rgb9e5(const vec3& color);
[[nodiscard]] vec3 unpack_rgb9e5(std::uint32_t value);

/// A direction as the octahedron unfolded into a square of 4096 x 4096 points (Meyer et al. 2010,
/// "On Floating-Point Normal Vectors"): within a tenth of a degree. 24 bits; x lowest.
[[nodiscard]] std::uint32_t pack_normal(const vec3& direction);
/// @return unit length
[[nodiscard]] vec3 unpack_normal(std::uint32_t value);

/// The same on 11 x 11 points, 0 to 120: which side of a cell is which.
[[nodiscard]] std::uint32_t pack_coarse_direction(const vec3& direction);
[[nodiscard]] vec3 unpack_coarse_direction(std::uint32_t value);
inline constexpr std::uint32_t kCoarseDirections = 121;

}  // namespace octavo
