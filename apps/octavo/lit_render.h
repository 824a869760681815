// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "light_choice.h"
#include "octavo/io/model.h"
#include "octavo/light/light_cells.h"
#include "octavo/render/render_lit.h"

namespace octavo::cli {

/// What `render` was asked for, where light is sent on.
struct LitArguments {
    Lighting lighting = Lighting::gathered;
    LightChoice choice;
    LightOptions light;
    bool quiet = false;  // do not say that cells are lit here
};

/// A scene that is ready to be rendered.
struct LitInput {
    std::vector<Model> models;
    LitScene scene;
    std::optional<Camera> camera;  // of a scene file
};

/// Reads an .octv file, or a scene of several from a .json file. The light that an .octv file has
/// is used where the arguments ask for no other light or sky; else, and for scenes, cells are lit
/// here, which is said on standard error: it may take minutes, and is not kept.
[[nodiscard]] LitInput read_lit_input(const std::filesystem::path& path,
                                      const LitArguments& arguments);

}  // namespace octavo::cli
