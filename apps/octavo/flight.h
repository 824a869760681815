// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>

#include "camera_path.h"
#include "octavo/core/box.h"
#include "octavo/io/model.h"

namespace octavo::cli {

/// --path and --frames.
void add_flight_options(CLI::App& command, std::filesystem::path& path, int& frames);

/// The pictures that a benchmark of rays takes of a DAG: along a path, or around.
class Flight {
public:
    /// @param path    of the camera; none: a camera among the voxels turns about itself, one
    ///                outside circles the middle, so that it is back where it began after the last
    ///                frame
    /// @param frames  0: as many as the path says, or 32
    /// @param aspect  width of a picture through its height
    Flight(const Model& model, std::optional<CameraPath> path, int frames, double aspect);

    [[nodiscard]] int frames() const { return frames_; }
    [[nodiscard]] Camera camera(int frame) const;
    /// The light of all its pictures.
    [[nodiscard]] const Light& sun() const { return sun_; }
    /// How far ambient rays go, world units.
    [[nodiscard]] double ambient_radius() const;

private:
    std::optional<CameraPath> path_;
    Box content_;
    Camera start_;
    Light sun_;
    int frames_;
};

}  // namespace octavo::cli
