// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "octavo/mesh/scene.h"

namespace octavo {

/// Reads a scene in a process of its own, so that a library which crashes, hangs or takes all
/// memory on a damaged file only ends that process. It has this one's rights: no protection against
/// code that means harm.
///
/// @param read         what to do there; an Error that it throws arrives here
/// @param max_bytes    of memory that it may take beyond what this process has
/// @param max_seconds  after which it is killed
/// @throws Error       what `read` throws; bad_input where the process dies; limit where it passes
///                     one of these
[[nodiscard]] Scene read_in_child(const std::filesystem::path& file,
                                  const std::function<Scene()>& read, std::uint64_t max_bytes,
                                  double max_seconds);

}  // namespace octavo
