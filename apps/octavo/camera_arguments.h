// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "octavo/io/model.h"
#include "octavo/mesh/scene.h"

namespace octavo::cli {

/// Which camera a picture is to have.
struct CameraArguments {
    std::string name;
    std::optional<dvec3> eye;
    std::optional<dvec3> at;
    std::optional<double> fov_degrees;
    bool overview = false;

    /// Whether they say nothing of where the camera stands.
    [[nodiscard]] bool leave_it_open() const { return name.empty() && !eye && !overview; }
};

/// --camera, --eye, --at, --fov and --overview.
void add_camera_options(CLI::App& command, CameraArguments& arguments);

/// The camera that the arguments describe: by name, by `--eye`, else the file's first one. A file
/// without cameras, or `--overview`, is framed as a whole.
[[nodiscard]] Camera chosen_camera(const CameraArguments& arguments, const Model& model,
                                   const dvec3& up, double aspect);

/// A line for who wonders at the picture: that the camera stands in a full voxel, that it sees
/// none, or that it is the file's own and nobody asked for it; empty where there is nothing to say.
/// Cost: some 500 rays.
[[nodiscard]] std::string camera_remark(const CameraArguments& arguments, const Camera& camera,
                                        const Model& model, double aspect);

}  // namespace octavo::cli
