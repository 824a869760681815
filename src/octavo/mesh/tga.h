// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "octavo/mesh/bitmap.h"

namespace octavo {

/// A black picture. @throws Error bad_input without pixels; limit with too many
[[nodiscard]] Bitmap make_bitmap(std::int64_t width, std::int64_t height);

/// TGA has no magic number; these bytes have a header that says what no other format's would.
[[nodiscard]] bool looks_like_tga(std::span<const std::byte> encoded);

/// Reads grey, RGB and RGBA of 8, 24 and 32 bits, plain or in runs. @throws Error as decode_bitmap
[[nodiscard]] Bitmap decode_tga(std::span<const std::byte> encoded);

}  // namespace octavo
