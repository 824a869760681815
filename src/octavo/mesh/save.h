// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "octavo/mesh/scene.h"

namespace octavo {

/// Writes a scene; the file's extension chooses the format:
///
/// - `.glb`  everything. Positions are floats around a translated node, so that a scene far from
///           the origin keeps its detail; pictures go into the file. At most 4 GiB, as the format
///           has it.
/// - `.obj`  triangles, texture coordinates (the base colour's: the format has one set), vertex
///           colours without alpha, exact coordinates.
///           A `.mtl` beside it has the materials: textures that are files in the same folder or
///           below are named, all others written as NAME-NUMBER.png, .jpg or .tga.
/// - `.ply`  binary: triangles and vertex colours; coordinates are floats where that loses nothing,
///           else doubles. No materials.
///
/// The file appears whole or not at all: it is written under another name first and then renamed.
/// A file that exists is replaced.
///
/// @throws Error  io where writing fails; limit where the format cannot hold the scene;
///                bad_argument for another extension
void save_scene(const Scene& scene, const std::filesystem::path& file);

/// Whether the file's extension is one of these.
[[nodiscard]] bool can_save_scene(const std::filesystem::path& file);

}  // namespace octavo
