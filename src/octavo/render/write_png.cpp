// SPDX-License-Identifier: MIT
#include <png.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "octavo/core/error.h"
#include "octavo/render/image.h"
#include "octavo/render/tone_map.h"
#include "octavo/render/write_file.h"

namespace octavo {
namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

}  // namespace

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
    detail::write_and_rename(file, [&](const std::filesystem::path& unfinished) {
        const std::unique_ptr<std::FILE, Close> out(std::fopen(unfinished.c_str(), "wb"));
        if (!out) throw io_error(file, "write");
        if (png_image_write_to_stdio(&png, out.get(), 0, bytes.data(), 0, nullptr) == 0)
            throw Error(Errc::io, file, std::string("cannot write: ") + png.message);
        if (std::fflush(out.get()) != 0 || fsync(fileno(out.get())) != 0)
            throw io_error(file, "write");
    });
}

}  // namespace octavo
