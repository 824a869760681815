// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "octavo/mesh/scene.h"

/// One writer per format; `save_scene` chooses.
namespace octavo::formats {

void write_glb(const Scene& scene, const std::filesystem::path& file);
void write_obj(const Scene& scene, const std::filesystem::path& file);
void write_ply(const Scene& scene, const std::filesystem::path& file);

/// Whether every coordinate is a float already.
[[nodiscard]] bool floats_are_exact(const Scene& scene);

}  // namespace octavo::formats
