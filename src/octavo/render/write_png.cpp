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

void write_png(const std::filesystem::path& file, const Image& image, double exposure) {
    if (image.color.empty()) throw Error(Errc::bad_argument, file, "the image has no pixel");

    const float scale = static_cast<float>(std::exp2(exposure));
    std::vector<std::uint8_t> bytes;
    bytes.reserve(3 * image.color.size());
    for (const vec3& color : image.color)
        for (const std::uint8_t byte : tone_map(color, scale)) bytes.push_back(byte);

    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = static_cast<png_uint_32>(image.width);
    png.height = static_cast<png_uint_32>(image.height);
    png.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
    std::vector<std::byte> encoded(size);
    if (png_image_write_to_memory(&png, encoded.data(), &size, 0, bytes.data(), 0, nullptr) == 0)
        throw Error(Errc::io, file, std::string("cannot write: ") + png.message);

    AtomicFile out(file);
    out.write(0, std::span(encoded).first(size));
    out.commit();
}

}  // namespace octavo
