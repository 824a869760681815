// SPDX-License-Identifier: MIT
#include "octavo/mesh/bitmap.h"

#include <png.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>

#include "octavo/core/error.h"
#include "octavo/mesh/tga.h"

namespace octavo {
namespace {

constexpr std::int64_t kMaxSide = 16384;
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 27;  // 512 MiB of bytes

bool begins_with(std::span<const std::byte> bytes, std::initializer_list<unsigned char> start) {
    return bytes.size() >= start.size() &&
           std::memcmp(bytes.data(), start.begin(), start.size()) == 0;
}

Bitmap decode_png(std::span<const std::byte> encoded) {
    png_image image;
    std::memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
    const std::unique_ptr<png_image, void (*)(png_image*)> guard(&image, png_image_free);
    if (!png_image_begin_read_from_memory(&image, encoded.data(), encoded.size()))
        throw Error(Errc::bad_input, std::string("is not a valid PNG: ") + image.message);
    Bitmap picture = make_bitmap(image.width, image.height);
    image.format = PNG_FORMAT_RGBA;
    if (!png_image_finish_read(&image, nullptr, picture.pixels.data(), 0, nullptr))
        throw Error(Errc::bad_input, std::string("is not a valid PNG: ") + image.message);
    return picture;
}

Bitmap decode_jpeg(std::span<const std::byte> encoded) {
    const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
    const auto* bytes = reinterpret_cast<const unsigned char*>(encoded.data());
    const auto size = static_cast<unsigned long>(encoded.size());
    const auto refuse = [&](Errc code) {
        throw Error(
            code, std::string("is not a JPEG that can be read: ") + tjGetErrorStr2(decoder.get()));
    };
    if (!decoder) throw Error(Errc::limit, "does not fit into memory");
    int width = 0, height = 0, sampling = 0, space = 0;
    if (tjDecompressHeader3(decoder.get(), bytes, size, &width, &height, &sampling, &space) != 0)
        refuse(Errc::bad_input);
    if (space == TJCS_CMYK || space == TJCS_YCCK)
        throw Error(Errc::unsupported, "is a JPEG in CMYK, for print");
    Bitmap picture = make_bitmap(width, height);
    // A warning, as for a file that is cut off, still gives a picture; but not the one that was
    // meant.
    if (tjDecompress2(decoder.get(), bytes, size,
                      reinterpret_cast<unsigned char*>(picture.pixels.data()), width, 0, height,
                      TJPF_RGBA, TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS) != 0)
        refuse(Errc::bad_input);
    return picture;
}

}  // namespace

Bitmap make_bitmap(std::int64_t width, std::int64_t height) {
    if (width < 1 || height < 1) throw Error(Errc::bad_input, "has no pixels");
    if (width > kMaxSide || height > kMaxSide || width * height > kMaxPixels)
        throw Error(Errc::limit, "has " + std::to_string(width) + " x " + std::to_string(height) +
                                     " pixels; 16384 a side and 2^27 in all are the most");
    Bitmap picture;
    picture.width = static_cast<int>(width);
    picture.height = static_cast<int>(height);
    picture.pixels.resize(static_cast<std::size_t>(width * height));
    return picture;
}

Bitmap decode_bitmap(std::span<const std::byte> encoded) {
    if (begins_with(encoded, {0x89, 'P', 'N', 'G'})) return decode_png(encoded);
    if (begins_with(encoded, {0xff, 0xd8, 0xff})) return decode_jpeg(encoded);
    if (looks_like_tga(encoded)) return decode_tga(encoded);
    throw Error(Errc::unsupported, "is no PNG, JPEG or TGA");
}

}  // namespace octavo
