// SPDX-License-Identifier: MIT
#include "lit_render.h"

#include <fmt/format.h>

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

/// @param why   there is no light that could be read instead
/// @param keep  what would keep it
void light_here(LitScene& scene, const LitArguments& arguments, const std::string& why,
                const std::string& keep) {
    if (arguments.lighting == Lighting::reference) return;
    std::uint64_t cells = 0;
    for (const LitObject& object : scene.objects) cells += object.attributes.cells().count();
    if (!arguments.quiet)
        fmt::print(stderr, "octavo: {}: lighting {} cells for this picture alone{}\n", why, cells,
                   keep);
    light_cells(scene, arguments.light);
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
    light_here(input.scene, arguments, "light of a scene file is not stored", "");
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
    light_here(input.scene, arguments,
               model.metadata.light ? "the stored light is of other lamps or another sky"
                                    : "no light is stored in " + path.string(),
               "; `octavo light " + path.string() +
                   "`, with the same --sun, --light, --sky and --bounces, would keep it");
    return input;
}

}  // namespace octavo::cli
