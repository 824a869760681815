// SPDX-License-Identifier: MIT
#include "octavo/mesh/confined_path.h"

#include <algorithm>
#include <charconv>
#include <string>

namespace octavo {
namespace fs = std::filesystem;

namespace {

std::optional<fs::path> resolved_inside(const fs::path& folder, const fs::path& file) {
    std::error_code error;
    const fs::path root = fs::weakly_canonical(folder, error);
    if (error) return {};
    const fs::path target = fs::weakly_canonical(file, error);
    if (error) return {};
    const auto [at_root, at_target] =
        std::mismatch(root.begin(), root.end(), target.begin(), target.end());
    if (at_root != root.end() || at_target == target.end()) return {};
    return target;
}

}  // namespace

std::optional<fs::path> confined_path(const fs::path& folder, std::string_view reference) {
    if (reference.empty() || reference.find('\0') != std::string_view::npos) return {};
    std::string name(reference);
    // Files from Windows separate folders by backslashes, which here would be part of a name.
    std::error_code error;
    if (name.find('\\') != std::string::npos && !fs::exists(folder / name, error))
        std::replace(name.begin(), name.end(), '\\', '/');
    return resolved_inside(folder, folder / name);
}

bool is_inside(const fs::path& folder, const fs::path& file) {
    return resolved_inside(folder, file).has_value();
}

fs::path folder_of(const fs::path& file) {
    return fs::absolute(file).parent_path();
}

std::string percent_decoded(std::string_view text) {
    std::string decoded;
    decoded.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned char byte = 0;
        if (text[i] == '%' && i + 2 < text.size()) {
            const char* first = text.data() + i + 1;
            if (std::from_chars(first, first + 2, byte, 16).ptr == first + 2) {
                decoded += static_cast<char>(byte);
                i += 2;
                continue;
            }
        }
        decoded += text[i];
    }
    return decoded;
}

}  // namespace octavo
