// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "octavo/core/vec.h"

namespace octavo {

/// A picture in linear light: width * height pixels, row by row, the top row first.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<vec3> color;  // linear sRGB primaries; 1 is a white surface in full light
    std::vector<float>
        depth;  // world units along the view direction; infinity where the ray missed

    Image() = default;
    Image(int w, int h)
        : width(w),
          height(h),
          color(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)),
          depth(color.size()) {}

    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    }
    friend bool operator==(const Image&, const Image&) = default;
};

/// The tone-mapped picture: 3 bytes of sRGB for each pixel. @param exposure  as in write_png
[[nodiscard]] std::vector<std::uint8_t> screen_pixels(const Image& image, double exposure);

/// The same as a PNG file. @throws Error  limit where it cannot be encoded
[[nodiscard]] std::vector<std::byte> encode_png(const Image& image, double exposure);

/// Writes the tone-mapped picture as 8-bit sRGB. Written beside `file` and renamed, so that an
/// interrupted write leaves an old file whole.
///
/// @param exposure  stops: each doubles the light
/// @throws Error    io where the file cannot be written; bad_argument where the image has no pixel
void write_png(const std::filesystem::path& file, const Image& image, double exposure = 0.0);

/// Writes the linear picture as OpenEXR: channels R, G, B (half) and Z (float). Renamed and refused
/// as by write_png.
void write_exr(const std::filesystem::path& file, const Image& image);

/// That write_image() knows the file name's extension. @throws Error bad_argument where it does not
void check_picture_name(const std::filesystem::path& file);

/// Writes by the file name's extension, .png or .exr.
/// @throws Error  bad_argument on any other; as write_png
void write_image(const std::filesystem::path& file, const Image& image, double exposure = 0.0);

}  // namespace octavo
