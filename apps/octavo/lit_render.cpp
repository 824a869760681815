// SPDX-License-Identifier: MIT
#include "lit_render.h"

#include "arguments.h"
#include "lit_arguments.h"
#include "octavo/io/octv.h"

namespace octavo::cli {
namespace {

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
    SceneFile file = read_scene_file(path, up);
    LitInput input{std::move(file.models), std::move(file.scene), file.camera};
    for (const Model& model : input.models) check_colored(model, path, arguments.lighting);
    const Model& first = input.models.front();
    const bool own = !arguments.sun && arguments.lights.empty();
    input.scene.lights = without_shining_cells(
        own && file.lights ? *std::move(file.lights)
                           : described_lights(arguments.sun, arguments.lights, first, up),
        first.attributes);
    if (arguments.sky) input.scene.sky = sky_of(*arguments.sky, up);
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

    const bool own_light =
        model.metadata.light && !arguments.sun && arguments.lights.empty() &&
        (!arguments.sky || is_stored_sky(*arguments.sky, model.metadata.light->sky, path));
    if (own_light) {
        input.scene.lights = model.metadata.light->lights;
        input.scene.sky = arguments.sky ? sky_of(*arguments.sky, up)
                                        : parse_stored_sky(model.metadata.light->sky, up, path);
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
