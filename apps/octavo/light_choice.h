// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "octavo/io/model.h"
#include "octavo/light/sky.h"

namespace octavo::cli {

/// What a scene is to be lit by; a part that nobody gave is the file's own, or usual.
struct LightChoice {
    std::optional<std::array<double, 2>> sun;  // azimuth and elevation
    std::vector<std::string> lights;           // see light_arguments.h
    std::optional<std::string> sky;            // see sky_arguments.h
    dvec3 up{0.0, 1.0, 0.0};

    [[nodiscard]] bool leaves_lamps_open() const { return !sun && lights.empty(); }
};

/// --sun, --light, --sky and --up.
void add_light_choice(CLI::App& command, LightChoice& choice);

/// The lights of the choice; else those of the file; else none.
[[nodiscard]] std::optional<std::vector<Light>> asked_lights(const LightChoice& choice,
                                                             const Model& model);
/// The same, and where there is none a sun to the left of a camera that sees the whole.
[[nodiscard]] std::vector<Light> described_lights(const LightChoice& choice, const Model& model);

/// @throws Error  bad_argument naming --sky; as load_sky_image()
[[nodiscard]] Sky chosen_sky(const LightChoice& choice);

/// The scene's lights without those that its shining cells are already: lamps of triangles, where
/// the attributes have emission.
[[nodiscard]] std::vector<Light> without_shining_cells(std::vector<Light> lights,
                                                       const Attributes& attributes);

}  // namespace octavo::cli
