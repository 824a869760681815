// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>

#include "octavo/mesh/scene.h"

namespace octavo {

/// What reading a scene file may take; beyond it is an Error `limit`.
struct LoadLimits {
    /// For vertices and triangles, which a small file may repeat without end by instancing a mesh,
    /// and for what is inflated. 0: half of the machine's memory.
    std::uint64_t max_bytes = 0;
    /// For what is read in a process of its own: the formats of assimp, and Draco data.
    double max_seconds = 600.0;
};

/// Reads a triangle scene: glTF and GLB, OBJ with its materials, PLY, STL, each also gzipped, and
/// whatever else the assimp library knows by its file name (OFF, COLLADA, 3DS, ...).
///
/// Coordinates are as exact as the file: text is rounded once to double, node transforms are
/// applied in double (assimp's formats: in float). Vertex colours and material colours are taken as
/// linear. Textures are not decoded. What the file has and the scene cannot hold becomes a warning.
///
/// Nothing outside the scene file's folder is read, whatever the file or a symbolic link says: a
/// texture there is left out with a warning, a buffer or a material library is an error.
///
/// @throws Error  io where the file is missing or unreadable; bad_input where its content is not
///                what its format says, or has no triangles; unsupported where no reader knows it;
///                limit where it has more than 2^32 vertices or triangles, or passes the limits
///
/// assimp, and the reader of a glTF file with Draco data, run in a process of their own, as the
/// libraries may crash on damaged files: that is then an Error.
[[nodiscard]] Scene load_scene(const std::filesystem::path& file, const LoadLimits& limits = {});

}  // namespace octavo
