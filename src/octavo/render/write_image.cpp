// SPDX-License-Identifier: MIT
#include <cstdio>
#include <string>
#include <system_error>

#include "octavo/core/error.h"
#include "octavo/render/image.h"
#include "octavo/render/write_file.h"

namespace octavo {

void detail::write_and_rename(const std::filesystem::path& file,
                              const std::function<void(const std::filesystem::path&)>& write) {
    std::filesystem::path unfinished = file;
    unfinished += ".unfinished";
    try {
        write(unfinished);
        if (std::rename(unfinished.c_str(), file.c_str()) != 0) throw io_error(file, "replace");
    } catch (...) {
        std::error_code ignored;
        std::filesystem::remove(unfinished, ignored);
        throw;
    }
}

void write_image(const std::filesystem::path& file, const Image& image, double exposure) {
    const std::string extension = file.extension().string();
    if (extension == ".png") return write_png(file, image, exposure);
    if (extension == ".exr") return write_exr(file, image);
    throw Error(Errc::bad_argument, file, "a picture's name ends in .png or .exr");
}

}  // namespace octavo
