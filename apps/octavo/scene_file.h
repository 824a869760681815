// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "octavo/io/model.h"
#include "octavo/light/lit_scene.h"

namespace octavo::cli {

/// Several .octv files in places, with light: a JSON file, whose keys are in docs/lighting.md.
struct SceneFile {
    LitScene scene;             // objects and sky
    std::vector<Model> models;  // of the objects, in their order
    std::optional<std::vector<Light>> lights;
    std::optional<Camera> camera;
};

/// Opens no file outside the folder of the scene file.
/// @param up      which way is up, for its lights, sky and camera
/// @throws Error  io; bad_input naming the key; limit; as read_octv()
[[nodiscard]] SceneFile read_scene_file(const std::filesystem::path& path, const dvec3& up);

}  // namespace octavo::cli
