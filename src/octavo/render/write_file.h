// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>

namespace octavo::detail {

/// Writes a file under another name beside it, then renames: whoever looks sees the old file or the
/// whole new one. Whatever `write` throws is passed on, and the unfinished file removed.
void write_and_rename(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path& unfinished)>& write);

}  // namespace octavo::detail
