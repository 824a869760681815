// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "camera_arguments.h"
#include "light_choice.h"
#include "octavo/light/light_cells.h"
#include "octavo/render/render.h"

namespace octavo::cli {

/// What `octavo render` was asked for.
struct RenderArguments {
    std::filesystem::path file;
    std::filesystem::path output;
    uvec2 size{1280, 720};
    double exposure = 0.0;
    bool trusted = false;
    bool force = false;
    bool quiet = false;

    CameraArguments camera;
    LightChoice light;
    std::string gi;  // "", "gathered" or "cached"
    bool reference = false;
    int bounces = LightOptions{}.bounces;

    bool primary_mesh = false;
    std::filesystem::path dag;
    bool no_color = false;
    bool flat_normals = false;

    bool samples_given = false;
    std::string device = "cpu";
    RenderOptions options;  // of the rest, what was given

    [[nodiscard]] double aspect() const { return static_cast<double>(size.x) / size.y; }
};

/// Adds FILE and all options.
void add_render_options(CLI::App& command, RenderArguments& arguments);

}  // namespace octavo::cli
