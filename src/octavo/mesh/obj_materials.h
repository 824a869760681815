// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "octavo/mesh/scene.h"

namespace octavo {

/// Adds the materials of an MTL file to the scene. Of a name defined twice the first counts.
/// @throws Error io
void read_obj_materials(const std::filesystem::path& file, Scene& scene,
                        std::map<std::string, std::uint32_t, std::less<>>& by_name);

}  // namespace octavo
