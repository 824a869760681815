// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

namespace octavo::cli {

/// The page as it was built. @throws Error unsupported where this build has none
[[nodiscard]] std::string_view viewer_page();

/// The page with what it is to show; web/src/config.ts reads this.
[[nodiscard]] std::string configured_page(const nlohmann::json& config);

/// The page with the file inside it, as base64: one HTML file of 4/3 the size. Goes to `write`
/// piece by piece.
void write_single_page(const std::string& name, std::span<const std::byte> file,
                       const std::function<void(std::string_view)>& write);

}  // namespace octavo::cli
