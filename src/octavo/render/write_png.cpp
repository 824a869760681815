// SPDX-License-Identifier: MIT
#include <png.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "octavo/core/atomic_file.h"
#include "octavo/core/error.h"
#include "octavo/render/image.h"
#include "octavo/render/tone_map.h"

namespace octavo {

std::vector<std::uint8_t> screen_pixels(const Image& image, double exposure) {
    const float scale = static_cast<float>(std::exp2(exposure));
    std::vector<std::uint8_t> bytes;
    bytes.reserve(3 * image.color.size());
    for (const vec3& color : image.color)
        for (const std::uint8_t byte : tone_map(color, scale)) bytes.push_back(byte);
    return bytes;
}

std::vector<std::byte> encode_png(const Image& image, double exposure) {
    const std::vector<std::uint8_t> pixels = screen_pixels(image, exposure);
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.width);
    png.height = static_cast<png_uint_32>(image.height);
    png.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    std::vector<std::byte> encoded(size);
    if (png_image_write_to_memory(&png, encoded.data(), &size, 0, pixels.data(), 0, nullptr) == 0)
        throw Error(Errc::limit, std::string("the picture cannot be encoded: ") + png.message);
    encoded.resize(size);
    return encoded;
}

void write_png(const std::filesystem::path& file, const Image& image, double exposure) {
    if (image.color.empty()) throw Error(Errc::bad_argument, file, "the image has no pixel");
    const std::vector<std::byte> encoded = encode_png(image, exposure);
    AtomicFile out(file);
    out.write(0, encoded);
    out.commit();
}

}  // namespace octavo
