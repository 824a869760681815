// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace octavo {

/// ".ply" of "scan.PLY": what formats are known by. Only the letters of ASCII change, in any
/// locale.
[[nodiscard]] inline std::string lowercase_extension(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return extension;
}

}  // namespace octavo
