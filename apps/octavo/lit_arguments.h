// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "octavo/core/progress.h"
#include "octavo/io/model.h"
#include "octavo/light/lit_scene.h"

/// How the command line writes skies and scenes:
///
///     clear                        the blue sky of the pictures
///     none
///     color:R,G,B                  the same everywhere
///     gradient:zenith=R,G,B:horizon=R,G,B:ground=R,G,B
///     FILE.exr, FILE.hdr           a picture of the whole sphere; :turn=DEGREES turns it
///
/// and behind any of them :power=FACTOR.
namespace octavo::cli {

/// @throws Error  bad_argument, saying what was expected; as load_sky_image()
[[nodiscard]] Sky parse_sky(const std::string& text, const dvec3& up);

/// A camera that a scene file asks for.
struct SceneCamera {
    dvec3 eye{0.0}, at{0.0};
    std::optional<double> fov_degrees;
};

/// What a scene file says; docs/lighting.md has its keys.
struct SceneFile {
    LitScene scene;                   // objects, with the light that their files have
    std::vector<Model> models;        // of the objects, in their order
    std::vector<std::string> lights;  // as --light has them
    std::optional<std::string> sky;   // as --sky has it
    std::optional<SceneCamera> camera;
};

/// @throws Error  io; bad_input naming the key; as read_octv()
[[nodiscard]] SceneFile read_scene_file(const std::filesystem::path& path);

/// The lights of the arguments; else those of the file; else none.
/// @param sun     as --sun has it: azimuth and elevation
/// @param lights  as --light has them
[[nodiscard]] std::optional<std::vector<Light>> asked_lights(
    const std::optional<std::array<double, 2>>& sun, const std::vector<std::string>& lights,
    const Model& model, const dvec3& up);
/// The same, and where there is none a sun to the left of a camera that sees the whole.
[[nodiscard]] std::vector<Light> described_lights(const std::optional<std::array<double, 2>>& sun,
                                                  const std::vector<std::string>& lights,
                                                  const Model& model, const dvec3& up);

/// Adds --sun and --light.
void add_light_choice(CLI::App& command, std::optional<std::array<double, 2>>& sun,
                      std::vector<std::string>& lights);

/// The scene's lights without those that its shining cells are already: lamps of triangles, where
/// the attributes have emission.
[[nodiscard]] std::vector<Light> without_shining_cells(std::vector<Light> lights,
                                                       const Attributes& attributes);

}  // namespace octavo::cli
