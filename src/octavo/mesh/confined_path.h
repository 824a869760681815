// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

namespace octavo {

/// Resolves what a scene file in `folder` calls another file by. Symbolic links are followed first,
/// so that the answer is where the bytes are.
///
/// @return  an absolute path in the folder or below it, of what need not exist; none where it leads
///          outside
[[nodiscard]] std::optional<std::filesystem::path> confined_path(
    const std::filesystem::path& folder, std::string_view reference);

/// The same for the file itself: whether it is in the folder or below, links followed.
[[nodiscard]] bool is_inside(const std::filesystem::path& folder,
                             const std::filesystem::path& file);

/// The folder that a scene file is in, absolute.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& file);

/// Decodes %41 and its like, which glTF's URIs have; a stray % stays as it is.
[[nodiscard]] std::string percent_decoded(std::string_view text);

}  // namespace octavo
