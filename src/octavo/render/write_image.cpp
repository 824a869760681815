// SPDX-License-Identifier: MIT
#include <string>

#include "octavo/core/error.h"
#include "octavo/core/file_name.h"
#include "octavo/render/image.h"

namespace octavo {

void write_image(const std::filesystem::path& file, const Image& image, double exposure) {
    const std::string extension = lowercase_extension(file);
    if (extension == ".png") return write_png(file, image, exposure);
    if (extension == ".exr") return write_exr(file, image);
    throw Error(Errc::bad_argument, file, "a picture's name ends in .png or .exr");
}

}  // namespace octavo
