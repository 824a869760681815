// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace octavo {

enum class PngChannels { rgb = 3, rgba = 4 };

/// Pixels of 8 bits a channel as a PNG file, row by row from the upper one.
/// @param pixels  width times height times the number of channels
/// @throws Error  limit where the picture cannot be encoded
[[nodiscard]] std::vector<std::byte> encode_png(std::span<const std::uint8_t> pixels, int width,
                                                int height, PngChannels channels);

}  // namespace octavo
