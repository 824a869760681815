// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "octavo/mesh/scene.h"

namespace octavo {

/// Writes a scene as bytes for another process of the same program: no format to keep.
/// @param descriptor  of a file open for writing
/// @param scene       stays as it is; not const, as one text visits it to write and to read
/// @throws Error io
void write_scene(int descriptor, Scene& scene);

/// @throws Error bad_input  where the bytes are no scene: the writer may have been damaged
[[nodiscard]] Scene read_scene_bytes(std::span<const std::byte> bytes);

}  // namespace octavo
