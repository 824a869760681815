// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "octavo/core/atomic_file.h"
#include "octavo/core/error.h"
#include "octavo/mesh/png.h"
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
    return encode_png(screen_pixels(image, exposure), image.width, image.height, PngChannels::rgb);
}

void write_png(const std::filesystem::path& file, const Image& image, double exposure) {
    if (image.color.empty()) throw Error(Errc::bad_argument, file, "the image has no pixel");
    const std::vector<std::byte> encoded = encode_png(image, exposure);
    AtomicFile out(file);
    out.write(0, encoded);
    out.commit();
}

}  // namespace octavo
