// SPDX-License-Identifier: MIT
#include "lit_render.h"

#include <fmt/format.h>

#include "octavo/io/octv.h"
#include "scene_file.h"
#include "sky_arguments.h"

namespace octavo::cli {
namespace {

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

LitInput read_scene(const std::filesystem::path& path, const LitArguments& arguments) {
    const LightChoice& choice = arguments.choice;
    SceneFile file = read_scene_file(path, choice.up);
    LitInput input{std::move(file.models), std::move(file.scene), file.camera};
    for (const Model& model : input.models) check_colored(model, path, arguments.lighting);
    const Model& first = input.models.front();
    input.scene.lights = without_shining_cells(choice.leaves_lamps_open() && file.lights
                                                   ? *std::move(file.lights)
                                                   : described_lights(choice, first),
                                               first.attributes);
    if (choice.sky) input.scene.sky = chosen_sky(choice);
    light_here(input.scene, arguments, "light of a scene file is not stored", "");
    return input;
}

}  // namespace

LitInput read_lit_input(const std::filesystem::path& path, const LitArguments& arguments) {
    if (path.extension() == ".json") return read_scene(path, arguments);
    const LightChoice& choice = arguments.choice;
    LitInput input;
    input.models.push_back(read_octv(path));
    const Model& model = input.models.front();
    check_colored(model, path, arguments.lighting);
    input.scene.objects.push_back(
        {.dag = model.dag, .grid = model.grid(), .attributes = model.attributes});

    const bool own_light =
        model.metadata.light && choice.leaves_lamps_open() &&
        (!choice.sky || is_stored_sky(*choice.sky, model.metadata.light->sky, path));
    if (own_light) {
        input.scene.lights = model.metadata.light->lights;
        input.scene.sky = choice.sky ? chosen_sky(choice)
                                     : parse_stored_sky(model.metadata.light->sky, choice.up, path);
        input.scene.objects[0].light = model.light;
        return input;
    }
    input.scene.lights = without_shining_cells(described_lights(choice, model), model.attributes);
    input.scene.sky = chosen_sky(choice);
    light_here(input.scene, arguments,
               model.metadata.light ? "the stored light is of other lamps or another sky"
                                    : "no light is stored in " + path.string(),
               "; `octavo light " + path.string() +
                   "`, with the same --sun, --light, --sky and --bounces, would keep it");
    return input;
}

}  // namespace octavo::cli
