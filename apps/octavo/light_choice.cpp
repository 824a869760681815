// SPDX-License-Identifier: MIT
#include "light_choice.h"

#include <utility>

#include "arguments.h"
#include "light_arguments.h"
#include "octavo/render/render.h"
#include "sky_arguments.h"

namespace octavo::cli {
namespace {

/// What there is to light.
Box lit_box(const Model& model) {
    return framed_box(model.dag, model.grid());
}

}  // namespace

void add_light_choice(CLI::App& command, LightChoice& choice) {
    add_parsed(command, "--sun", choice.sun, parse_angles,
               "Where the sun stands: degrees from +z towards +x, and above the horizon",
               "AZIMUTH,ELEVATION");
    command
        .add_option("--light", choice.lights,
                    "A light; may be given several times. sun:AZIMUTH,ELEVATION, point:X,Y,Z, "
                    "spot:X,Y,Z:to=X,Y,Z:angle=DEGREES, disc:X,Y,Z:to=X,Y,Z:size=RADIUS, "
                    "rectangle:X,Y,Z:to=X,Y,Z:size=WxH, each with :size=, :color=R,G,B, "
                    ":power=FACTOR; scene or scene=NAME for those of the file, none for the sky "
                    "alone. Otherwise those of the file, or a sun from the left")
        ->type_name("LIGHT")
        ->allow_extra_args(false);
    command
        .add_option("--sky", choice.sky,
                    "clear (the default), none, color:R,G,B, "
                    "gradient:zenith=R,G,B:horizon=R,G,B:ground=R,G,B, or an .exr or .hdr picture; "
                    "with :power=FACTOR, a picture also with :turn=DEGREES")
        ->type_name("SKY");
    add_parsed(command, "--up", choice.up, parse_vec3,
               "Which way is up, for camera, sun and sky; 0,1,0", "X,Y,Z");
}

std::optional<std::vector<Light>> asked_lights(const LightChoice& choice, const Model& model) {
    std::vector<LightArgument> described;
    if (choice.sun) described.push_back({.light = unit_sun(*choice.sun, choice.up)});
    for (const std::string& text : choice.lights) {
        try {
            described.push_back(parse_light(text, choice.up));
        } catch (const Error& error) {
            throw Error(Errc::bad_argument, std::string("--light: ") + error.what());
        }
    }
    const Box lit = lit_box(model);
    if (!described.empty()) return chosen_lights(described, model.metadata.lights, lit);
    if (!model.metadata.lights.empty()) return balanced(model.metadata.lights, lit);
    return std::nullopt;
}

std::vector<Light> described_lights(const LightChoice& choice, const Model& model) {
    if (auto asked = asked_lights(choice, model)) return *std::move(asked);
    return {default_sun(default_camera(lit_box(model), choice.up, 16.0 / 9.0), choice.up)};
}

Sky chosen_sky(const LightChoice& choice) {
    try {
        return parse_sky(choice.sky.value_or("clear"), choice.up);
    } catch (const Error& error) {
        if (error.code() != Errc::bad_argument) throw;
        throw Error(Errc::bad_argument, std::string("--sky: ") + error.what());
    }
}

std::vector<Light> without_shining_cells(std::vector<Light> lights, const Attributes& attributes) {
    if (attributes.has_emission())
        std::erase_if(lights, [](const Light& l) { return l.kind == Light::Kind::mesh; });
    return lights;
}

}  // namespace octavo::cli
