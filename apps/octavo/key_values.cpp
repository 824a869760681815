// SPDX-License-Identifier: MIT
#include "key_values.h"

#include <algorithm>

#include "octavo/core/error.h"

namespace octavo::cli {

KeyValues::KeyValues(std::string_view text) {
    while (!text.empty()) {
        const std::size_t end = text.find(':');
        const std::string_view part = text.substr(0, end);
        const std::size_t equals = part.find('=');
        if (equals == std::string_view::npos)
            throw Error(Errc::bad_argument, "'" + std::string(part) + "' is not KEY=VALUE");
        parts_.emplace_back(part.substr(0, equals), part.substr(equals + 1));
        text = end == std::string_view::npos ? "" : text.substr(end + 1);
    }
}

std::optional<std::string> KeyValues::take(std::string_view key) {
    const auto found = std::ranges::find(
        parts_, key, [](const auto& part) -> std::string_view { return part.first; });
    if (found == parts_.end()) return std::nullopt;
    std::string value = std::move(found->second);
    parts_.erase(found);
    return value;
}

void KeyValues::check_all_taken(const std::string& what) const {
    if (!parts_.empty())
        throw Error(Errc::bad_argument, what + " has no '" + parts_.front().first + "'");
}

}  // namespace octavo::cli
