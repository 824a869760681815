// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string_view>

#include "octavo/core/file_bytes.h"

namespace octavo {

/// Whether these bytes begin as gzip does.
[[nodiscard]] bool is_gzip(std::string_view bytes);

/// The content of a gzipped file, all members of it; byte offsets then count inflated bytes.
/// @throws Error bad_input; limit where it is longer than this
[[nodiscard]] FileBytes inflate_file(const FileBytes& compressed, std::uint64_t max_bytes);

}  // namespace octavo
