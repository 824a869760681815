// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "harness.h"

namespace octavo::fuzz {

/// A folder of this process, in memory where there is such a place, until it ends.
[[nodiscard]] const std::filesystem::path& folder();

/// Writes a file there, over one of that name.
std::filesystem::path put(const std::string& name, Bytes bytes);

}  // namespace octavo::fuzz
