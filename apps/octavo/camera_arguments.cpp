// SPDX-License-Identifier: MIT
#include "camera_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "arguments.h"
#include "degrees.h"
#include "octavo/render/render.h"
#include "octavo/trace/trace.h"

namespace octavo::cli {
namespace {

Camera named_camera(const std::vector<Camera>& cameras, const std::string& wanted) {
    const auto found = std::ranges::find(cameras, wanted, &Camera::name);
    if (found != cameras.end()) return *found;
    std::string names;
    for (const Camera& camera : cameras) names += (names.empty() ? "" : ", ") + camera.name;
    throw Error(Errc::bad_argument,
                "no camera '" + wanted + "'; the file has " + (names.empty() ? "none" : names));
}

/// Whether any of some rays, spread over the picture, meets a voxel.
bool sees_a_voxel(const Camera& camera, const Model& model, double aspect) {
    constexpr int kAcross = 31, kDown = 17;
    const dvec3 right = glm::cross(camera.forward, camera.up);
    const double half_height = std::tan(0.5 * camera.vertical_fov);
    for (int y = 0; y < kDown; ++y)
        for (int x = 0; x < kAcross; ++x) {
            const double u = (2.0 * x + 1.0) / kAcross - 1.0, v = (2.0 * y + 1.0) / kDown - 1.0;
            const dvec3 direction =
                camera.forward + half_height * (aspect * u * right + v * camera.up);
            if (trace_any(model.dag, model.grid(), {.origin = camera.eye, .direction = direction}))
                return true;
        }
    return false;
}

}  // namespace

void add_camera_options(CLI::App& command, CameraArguments& arguments) {
    CLI::Option* camera = command
                              .add_option("--camera", arguments.name,
                                          "A camera of the scene, by its name; otherwise its first")
                              ->type_name("NAME");
    CLI::Option* eye = add_parsed(command, "--eye", arguments.eye, parse_vec3,
                                  "Where the camera stands, world space", "X,Y,Z");
    add_parsed(command, "--at", arguments.at, parse_vec3,
               "What it looks at; otherwise the middle of the scene", "X,Y,Z")
        ->needs(eye);
    command.add_option("--fov", arguments.fov_degrees, "Vertical field of view")
        ->type_name("DEGREES")
        ->check(within(0.01, 179.0));
    CLI::Option* overview = command.add_flag("--overview", arguments.overview,
                                             "Frame the whole scene, as if it had no camera");
    camera->excludes(eye)->excludes(overview);
    overview->excludes(eye);
}

Camera chosen_camera(const CameraArguments& arguments, const Model& model, const dvec3& up,
                     double aspect) {
    Camera camera;
    if (!arguments.name.empty()) {
        camera = named_camera(model.metadata.cameras, arguments.name);
    } else if (arguments.leave_it_open() && !model.metadata.cameras.empty()) {
        camera = model.metadata.cameras.front();
    } else {
        const Box shown = framed_box(model.dag, model.grid());
        const double fov = arguments.fov_degrees.value_or(kDefaultFovDegrees) * kRadiansPerDegree;
        if (arguments.eye)
            return look_at(*arguments.eye, arguments.at.value_or(shown.centre()), up, fov);
        camera = default_camera(shown, up, aspect);
    }
    if (arguments.fov_degrees) camera.vertical_fov = *arguments.fov_degrees * kRadiansPerDegree;
    return camera;
}

std::string camera_remark(const CameraArguments& arguments, const Camera& camera,
                          const Model& model, double aspect) {
    if (model.dag.empty() || arguments.overview) return {};
    const bool of_the_file = arguments.leave_it_open() && !model.metadata.cameras.empty();
    const Ray ahead{.origin = camera.eye, .direction = camera.forward};
    const bool in_a_voxel = trace_closest(model.dag, model.grid(), ahead).face == Face::inside;
    const std::string who =
        arguments.eye ? "the camera" : fmt::format("the file's camera '{}'", camera.name);
    constexpr const char* kAdvice = "--overview frames the whole scene";
    if (in_a_voxel) return fmt::format("{} stands in a full voxel: {}", who, kAdvice);
    if (!sees_a_voxel(camera, model, aspect))
        return fmt::format("{} sees next to nothing: {}", who, kAdvice);
    if (of_the_file) return fmt::format("seen by {}; {}", who, kAdvice);
    return {};
}

}  // namespace octavo::cli
