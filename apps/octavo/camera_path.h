// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "octavo/io/json_field.h"
#include "octavo/mesh/scene.h"

namespace octavo::cli {

/// A flight of a camera, read from JSON; see bench/README.md for the file.
struct CameraPath {
    struct Key {
        dvec3 eye, at;
        double vertical_fov;  // radians
    };
    std::vector<Key> keys;  // one or more
    dvec3 up{0.0, 1.0, 0.0};
    int frames = 32;
    bool closed = false;  // the way leads back to the first key

    /// Frame `frame` of `count`: on a smooth curve (Catmull-Rom) through the keys, which follow
    /// each other after equal times.
    [[nodiscard]] Camera camera(int frame, int count) const;
};

/// A camera in a JSON file: its eye, what it looks at, and its vertical field of view in degrees,
/// 45. @throws Error  bad_input, naming the key
[[nodiscard]] CameraPath::Key read_camera_key(const JsonField& camera);

/// @throws Error  io; limit; bad_input, naming what is wrong
[[nodiscard]] CameraPath read_camera_path(const std::filesystem::path& file);

}  // namespace octavo::cli
