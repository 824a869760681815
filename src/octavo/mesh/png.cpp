// SPDX-License-Identifier: MIT
#include "octavo/mesh/png.h"

#include <png.h>

#include <string>

#include "octavo/core/error.h"

namespace octavo {

std::vector<std::byte> encode_png(std::span<const std::uint8_t> pixels, int width, int height,
                                  PngChannels channels) {
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(width);
    png.height = static_cast<png_uint_32>(height);
    png.format = channels == PngChannels::rgb ? PNG_FORMAT_RGB : PNG_FORMAT_RGBA;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    std::vector<std::byte> encoded(size);
    if (png_image_write_to_memory(&png, encoded.data(), &size, 0, pixels.data(), 0, nullptr) == 0)
        throw Error(Errc::limit, std::string("the picture cannot be encoded: ") + png.message);
    encoded.resize(size);
    return encoded;
}

}  // namespace octavo
