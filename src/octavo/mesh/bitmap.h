// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace octavo {

/// A decoded picture, as bytes of sRGB and, not premultiplied, alpha. The first row is the upper
/// one.
struct Bitmap {
    int width = 0;
    int height = 0;
    std::vector<std::array<std::uint8_t, 4>> pixels;  // row by row

    [[nodiscard]] const std::array<std::uint8_t, 4>& at(int x, int y) const {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

/// More than the largest picture takes uncompressed: of a longer file nothing is read.
inline constexpr std::uint64_t kMaxPictureBytes = std::uint64_t{1} << 31;

/// Decodes a PNG, JPEG or TGA picture; which one is told from the bytes. 16-bit channels are
/// rounded to 8 bits, grey and palettes are spread out.
///
/// @throws Error  bad_input where the bytes are damaged; unsupported where they are of another kind
///                or use what is rare (JPEG in CMYK); limit past 16384 pixels a side or 2^27 in all
[[nodiscard]] Bitmap decode_bitmap(std::span<const std::byte> encoded);

}  // namespace octavo
