// SPDX-License-Identifier: MIT
#include <string>

#include "octavo/core/error.h"
#include "octavo/core/file_name.h"
#include "octavo/render/image.h"

namespace octavo {

void check_picture_name(const std::filesystem::path& file) {
    const std::string extension = lowercase_extension(file);
    if (extension != ".png" && extension != ".exr")
        throw Error(Errc::bad_argument, file, "a picture's name ends in .png or .exr");
}

void write_image(const std::filesystem::path& file, const Image& image, double exposure) {
    check_picture_name(file);
    if (lowercase_extension(file) == ".exr") return write_exr(file, image);
    write_png(file, image, exposure);
}

}  // namespace octavo
