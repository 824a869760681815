// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "octavo/core/file_bytes.h"
#include "octavo/mesh/file_window.h"
#include "octavo/mesh/scene.h"

/// One reader per format; `load_scene` chooses. Each fills a scene, and may find that it has no
/// triangles. A window is given with the whole file ahead.
namespace octavo::formats {

/// A bad_input Error about a file with vertices but no triangles.
[[nodiscard]] inline Error only_points_or_lines(const std::filesystem::path& file) {
    return {Errc::bad_input, file,
            "has no triangles, only points or lines: it must be meshed first"};
}

/// .gltf and .glb.
/// @param max_bytes    of vertices and triangles, and of buffers @throws Error limit beyond
/// @param max_seconds  for a file with Draco data, which is read in a process of its own
[[nodiscard]] Scene read_gltf(const FileBytes& bytes, std::uint64_t max_bytes, double max_seconds);
[[nodiscard]] Scene read_obj(FileWindow& input);
[[nodiscard]] Scene read_ply(FileWindow& input);
[[nodiscard]] Scene read_stl(FileWindow& input);

/// Whether assimp has a reader for this file name.
[[nodiscard]] bool assimp_knows(const std::filesystem::path& file);
/// Opens the file itself, and may crash: see read_in_child(). @throws Error
[[nodiscard]] Scene read_with_assimp(const std::filesystem::path& file);

}  // namespace octavo::formats
