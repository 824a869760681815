// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "octavo/mesh/scene.h"

namespace octavo::cli {

/// The scene that an argument names: a file, or sample:NAME for a built-in one; with those of its
/// textures decoded that make holes in surfaces.
/// @throws Error  as load_scene() and make_sample() do
[[nodiscard]] Scene read_scene(const std::string& input);

/// What to call it in a file or a table: without folders, which differ between machines.
[[nodiscard]] std::string source_name(const std::string& input);

}  // namespace octavo::cli
