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

/// The sky as a file has it that was lit by it: a picture is named as from the file's folder.
[[nodiscard]] std::string stored_sky(const std::string& text, const std::filesystem::path& file);
/// Is `text`, which names a picture as from here, the sky that the file was lit by?
[[nodiscard]] bool is_stored_sky(const std::string& text, const std::string& stored,
                                 const std::filesystem::path& file);
/// The sky that a file was lit by. A stranger may have written the name: no picture outside the
/// file's folder is opened.
/// @throws Error  bad_input, naming the file; as load_sky_image()
[[nodiscard]] Sky parse_stored_sky(const std::string& stored, const dvec3& up,
                                   const std::filesystem::path& file);

/// The picture that a sky's text names; empty where it names none.
[[nodiscard]] std::filesystem::path sky_picture(const std::string& text);

/// What a scene file says; docs/lighting.md has its keys.
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
