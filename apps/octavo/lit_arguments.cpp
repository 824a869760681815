// SPDX-License-Identifier: MIT
#include "lit_arguments.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "arguments.h"
#include "key_values.h"
#include "light_arguments.h"
#include "octavo/io/octv.h"
#include "octavo/render/render.h"

namespace octavo::cli {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
constexpr std::size_t kMostSceneBytes = 16u << 20;

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& reason) {
    throw Error(Errc::bad_argument, reason);
}

vec3 light_color(const std::string& text) {
    const dvec3 color = parse_vec3(text);
    if (color.x < 0.0 || color.y < 0.0 || color.z < 0.0) refuse("a sky's light is not below 0");
    return vec3(color);
}

double number(const std::string& text) {
    return parse_vec3(text + ",0,0").x;
}

Sky named_sky(const std::string& kind, std::string first, KeyValues& parts, const dvec3& up) {
    if (kind == "none") return {};
    if (kind == "clear") return Sky::clear(up);
    if (kind == "color") return Sky::constant(light_color(first));
    if (kind == "gradient") {
        const auto color = [&](const char* key) {
            const auto text = parts.take(key);
            if (!text) refuse(std::string("a gradient needs ") + key + "=R,G,B");
            return light_color(*text);
        };
        const vec3 zenith = color("zenith"), horizon = color("horizon"), ground = color("ground");
        return Sky::gradient(zenith, horizon, ground, up);
    }
    if (!kind.ends_with(".exr") && !kind.ends_with(".hdr"))
        refuse("'" + kind + "' is not clear, none, color:, gradient: or a .exr or .hdr file");
    const auto turn = parts.take("turn");
    return Sky::image(load_sky_image(kind), up, turn ? number(*turn) * kRadiansPerDegree : 0.0);
}

dvec3 vector_of(const Json& json, const std::string& name) {
    if (!json.is_array() || json.size() != 3 ||
        !std::ranges::all_of(json, [](const Json& x) { return x.is_number(); }))
        throw Error(Errc::bad_input, name + " is not [x, y, z]");
    return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

double number_of(const Json& json, const std::string& name) {
    if (!json.is_number()) throw Error(Errc::bad_input, name + " is not a number");
    return json.get<double>();
}

const std::string& text_of(const Json& json, const std::string& name) {
    if (!json.is_string()) throw Error(Errc::bad_input, name + " is not a text");
    return json.get_ref<const std::string&>();
}

void check_keys(const Json& json, const std::string& name,
                std::initializer_list<std::string_view> known) {
    if (!json.is_object()) throw Error(Errc::bad_input, name + " is not an object");
    for (const auto& item : json.items())
        if (std::ranges::find(known, item.key()) == known.end())
            throw Error(Errc::bad_input, name + "/" + item.key() + " is not a key that is known");
}

dmat4 placement_of(const Json& json, const std::string& name) {
    dmat4 m(1.0);
    if (json.contains("position"))
        m = glm::translate(m, vector_of(json["position"], name + "/position"));
    if (json.contains("rotation")) {
        const Json& rotation = json["rotation"];
        check_keys(rotation, name + "/rotation", {"axis", "degrees"});
        const dvec3 axis = rotation.contains("axis")
                               ? vector_of(rotation["axis"], name + "/rotation/axis")
                               : dvec3(0, 1, 0);
        if (!(glm::length(axis) > 0.0))
            throw Error(Errc::bad_input, name + "/rotation/axis has no length");
        const double degrees = rotation.contains("degrees")
                                   ? number_of(rotation["degrees"], name + "/rotation/degrees")
                                   : 0.0;
        m = glm::rotate(m, degrees * kRadiansPerDegree, glm::normalize(axis));
    }
    if (json.contains("scale")) {
        const double scale = number_of(json["scale"], name + "/scale");
        if (!(scale > 0.0)) throw Error(Errc::bad_input, name + "/scale is not above 0");
        m = glm::scale(m, dvec3(scale));
    }
    return m;
}

/// What there is to light.
Box lit_box(const Model& model) {
    const Box box = content_bounds(model.dag, model.grid());
    return box.empty() ? model.grid().bounds() : box;
}

}  // namespace

Sky parse_sky(const std::string& text, const dvec3& up) {
    const std::size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon);
    std::string rest = colon == std::string::npos ? "" : text.substr(colon + 1);
    std::string first;
    if (kind == "color") {
        const std::size_t end = rest.find(':');
        first = rest.substr(0, end);
        rest = end == std::string::npos ? "" : rest.substr(end + 1);
    }
    KeyValues parts(rest);
    const auto power = parts.take("power");
    const Sky sky = named_sky(kind, first, parts, up);
    parts.check_all_taken("this sky");
    return power ? sky.scaled(static_cast<float>(parse_positive(*power))) : sky;
}

SceneFile read_scene_file(const std::filesystem::path& path) {
    SceneFile file;
    try {
        std::ifstream in(path, std::ios::binary | std::ios::ate);
        if (!in) throw io_error(path, "open");
        if (static_cast<std::uint64_t>(in.tellg()) > kMostSceneBytes)
            throw Error(Errc::bad_input, "a scene file has at most 16 MiB");
        in.seekg(0);
        const Json json = Json::parse(in);
        check_keys(json, "", {"objects", "lights", "sky", "camera"});
        if (!json.contains("objects") || !json["objects"].is_array() || json["objects"].empty())
            throw Error(Errc::bad_input, "/objects is not a list of objects");
        std::map<std::string, Model> models;
        std::size_t number = 0;
        for (const Json& object : json["objects"]) {
            const std::string name = "/objects/" + std::to_string(number++);
            check_keys(object, name, {"name", "file", "position", "rotation", "scale"});
            if (!object.contains("file")) throw Error(Errc::bad_input, name + " has no file");
            const std::string& of = text_of(object["file"], name + "/file");
            if (!models.contains(of)) models[of] = read_octv(path.parent_path() / of);
            const Model& model = models[of];
            file.models.push_back(model);
            file.scene.objects.push_back(
                {.name = object.contains("name") ? text_of(object["name"], name + "/name") : of,
                 .dag = model.dag,
                 .grid = model.grid(),
                 .attributes = model.attributes,
                 .placement = placement_of(object, name),
                 .light = {}});
        }
        if (json.contains("lights")) {
            if (!json["lights"].is_array()) throw Error(Errc::bad_input, "/lights is not a list");
            for (const Json& light : json["lights"])
                file.lights.push_back(text_of(light, "/lights"));
        }
        if (json.contains("sky")) file.sky = text_of(json["sky"], "/sky");
        if (json.contains("camera")) {
            const Json& camera = json["camera"];
            check_keys(camera, "/camera", {"eye", "at", "fov"});
            if (!camera.contains("eye") || !camera.contains("at"))
                throw Error(Errc::bad_input, "/camera needs eye and at");
            file.camera = {
                vector_of(camera["eye"], "/camera/eye"), vector_of(camera["at"], "/camera/at"), {}};
            if (camera.contains("fov"))
                file.camera->fov_degrees = number_of(camera["fov"], "/camera/fov");
        }
    } catch (const Json::exception& error) {
        throw Error(Errc::bad_input, path, std::string("not JSON: ") + error.what());
    } catch (const Error& error) {
        if (!error.file().empty() || error.code() == Errc::io) throw;
        throw Error(error.code(), path, error.what());
    }
    return file;
}

std::optional<std::vector<Light>> asked_lights(const std::optional<std::array<double, 2>>& sun,
                                               const std::vector<std::string>& lights,
                                               const Model& model, const dvec3& up) {
    std::vector<LightArgument> described;
    if (sun) described.push_back({.light = unit_sun(*sun, up)});
    for (const std::string& text : lights) {
        try {
            described.push_back(parse_light(text, up));
        } catch (const Error& error) {
            throw Error(Errc::bad_argument, std::string("--light: ") + error.what());
        }
    }
    const Box lit = lit_box(model);
    if (!described.empty()) return chosen_lights(described, model.metadata.lights, lit);
    if (!model.metadata.lights.empty()) return balanced(model.metadata.lights, lit);
    return std::nullopt;
}

std::vector<Light> described_lights(const std::optional<std::array<double, 2>>& sun,
                                    const std::vector<std::string>& lights, const Model& model,
                                    const dvec3& up) {
    if (auto asked = asked_lights(sun, lights, model, up)) return *std::move(asked);
    return {default_sun(default_camera(lit_box(model), up, 16.0 / 9.0), up)};
}

void add_light_choice(CLI::App& command, std::optional<std::array<double, 2>>& sun,
                      std::vector<std::string>& lights) {
    add_parsed(command, "--sun", sun, parse_angles,
               "Where the sun stands: degrees from +z towards +x, and above the horizon",
               "AZIMUTH,ELEVATION");
    command
        .add_option("--light", lights,
                    "A light; may be given several times. sun:AZIMUTH,ELEVATION, point:X,Y,Z, "
                    "spot:X,Y,Z:to=X,Y,Z:angle=DEGREES, disc:X,Y,Z:to=X,Y,Z:size=RADIUS, "
                    "rectangle:X,Y,Z:to=X,Y,Z:size=WxH, each with :size=, :color=R,G,B, "
                    ":power=FACTOR; scene or scene=NAME for those of the file, none for the sky "
                    "alone. Otherwise those of the file, or a sun from the left")
        ->type_name("LIGHT")
        ->allow_extra_args(false);
}

std::vector<Light> without_shining_cells(std::vector<Light> lights, const Attributes& attributes) {
    if (attributes.has_emission())
        std::erase_if(lights, [](const Light& l) { return l.kind == Light::Kind::mesh; });
    return lights;
}

}  // namespace octavo::cli
