// SPDX-License-Identifier: MIT
#include "flight.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "arguments.h"
#include "octavo/render/render.h"

namespace octavo::cli {
namespace {

constexpr int kFrames = 32;

const dvec3 kUp(0.0, 1.0, 0.0);

dvec3 turned(const dvec3& v, const dvec3& axis, double angle) {
    return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) +
           axis * glm::dot(axis, v) * (1.0 - std::cos(angle));
}

}  // namespace

void add_flight_options(CLI::App& command, std::filesystem::path& path, int& frames) {
    command
        .add_option("--path", path,
                    "A camera path, see bench/README.md; otherwise a turn about the first camera")
        ->type_name("JSON");
    command
        .add_option("--frames", frames,
                    "Pictures along the flight; otherwise as many as the path says, or 32")
        ->type_name("N")
        ->check(within(1, 100000));
}

Flight::Flight(const Model& model, std::optional<CameraPath> path, int frames, double aspect)
    : path_(std::move(path)),
      content_(framed_box(model.dag, model.grid())),
      start_(model.metadata.cameras.empty() ? default_camera(content_, kUp, aspect)
                                            : model.metadata.cameras.front()),
      sun_(default_sun(start_, kUp)),
      frames_(frames > 0 ? frames
              : path_    ? path_->frames
                         : kFrames) {}

Camera Flight::camera(int frame) const {
    if (path_) return path_->camera(frame, frames_);
    const double angle = 2.0 * std::numbers::pi * frame / frames_;
    const bool inside = glm::all(glm::greaterThan(start_.eye, content_.low)) &&
                        glm::all(glm::lessThan(start_.eye, content_.high));
    Camera camera = start_;
    camera.forward = turned(start_.forward, kUp, angle);
    camera.up = turned(start_.up, kUp, angle);
    if (!inside)
        camera.eye = content_.centre() + turned(start_.eye - content_.centre(), kUp, angle);
    return camera;
}

double Flight::ambient_radius() const {
    return kAmbientReach * glm::length(content_.size());
}

}  // namespace octavo::cli
