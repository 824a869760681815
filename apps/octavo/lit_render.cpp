// SPDX-License-Identifier: MIT
#include "lit_render.h"

#include <numbers>

#include "arguments.h"
#include "lit_arguments.h"
#include "octavo/io/octv.h"

namespace octavo::cli {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
constexpr double kDefaultFovDegrees = 45.0;

Sky sky_of(const std::string& text, const dvec3& up) {
    try {
        return parse_sky(text, up);
    } catch (const Error& error) {
        if (error.code() != Errc::bad_argument) throw;
        throw Error(Errc::bad_argument, std::string("--sky: ") + error.what());
    }
}

void check_colored(const Model& model, const std::filesystem::path& file, Lighting lighting) {
    if (model.attributes.empty() && lighting != Lighting::reference)
        throw Error(Errc::bad_argument, file,
                    "it has no attributes to light; build it with --attributes");
}

LitInput read_scene(const std::filesystem::path& path, const LitArguments& arguments,
                    const dvec3& up) {
    SceneFile file = read_scene_file(path);
    LitInput input{std::move(file.models), std::move(file.scene), {}};
    for (const Model& model : input.models) check_colored(model, path, arguments.lighting);
    const Model& first = input.models.front();
    const bool own = !arguments.sun && arguments.lights.empty();
    input.scene.lights = without_shining_cells(
        described_lights(arguments.sun, own ? file.lights : arguments.lights, first, up),
        first.attributes);
    const std::string sky = arguments.sky.value_or(file.sky.value_or("clear"));
    // A picture of the sky lies beside the scene, unless the command line names it.
    const bool picture =
        !arguments.sky && file.sky &&
        (sky.find(".hdr") != std::string::npos || sky.find(".exr") != std::string::npos);
    input.scene.sky = sky_of(picture ? (path.parent_path() / sky).string() : sky, up);
    if (file.camera)
        input.camera =
            look_at(file.camera->eye, file.camera->at, up,
                    file.camera->fov_degrees.value_or(kDefaultFovDegrees) * kRadiansPerDegree);
    if (arguments.lighting != Lighting::reference) light_cells(input.scene, arguments.light);
    return input;
}

}  // namespace

LitInput read_lit_input(const std::filesystem::path& path, const LitArguments& arguments,
                        const dvec3& up) {
    if (path.extension() == ".json") return read_scene(path, arguments, up);
    LitInput input;
    input.models.push_back(read_octv(path));
    const Model& model = input.models.front();
    check_colored(model, path, arguments.lighting);
    input.scene.objects.push_back(
        {.dag = model.dag, .grid = model.grid(), .attributes = model.attributes});

    const bool own_light = !arguments.sun && arguments.lights.empty() && !arguments.sky;
    if (own_light && model.metadata.light) {
        input.scene.lights = model.metadata.light->lights;
        input.scene.sky = sky_of(model.metadata.light->sky, up);
        input.scene.objects[0].light = model.light;
        return input;
    }
    input.scene.lights = without_shining_cells(
        described_lights(arguments.sun, arguments.lights, model, up), model.attributes);
    input.scene.sky = sky_of(arguments.sky.value_or("clear"), up);
    if (arguments.lighting != Lighting::reference) light_cells(input.scene, arguments.light);
    return input;
}

}  // namespace octavo::cli
