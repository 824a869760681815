// SPDX-License-Identifier: MIT
#include "lit_arguments.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <utility>

#include "arguments.h"
#include "camera_arguments.h"
#include "key_values.h"
#include "light_arguments.h"
#include "octavo/core/file_bytes.h"
#include "octavo/io/json_field.h"
#include "octavo/io/octv.h"
#include "octavo/mesh/confined_path.h"
#include "octavo/render/render.h"
#include "octavo/trace/instances.h"

namespace octavo::cli {
namespace {

constexpr std::uint64_t kMostSceneBytes = 16u << 20;
constexpr std::size_t kMostObjects = 10'000;

[[noreturn]] void refuse(const std::string& reason) {
    throw Error(Errc::bad_argument, reason);
}

double number(const std::string& text) {
    return parse_vec3(text + ",0,0").x;
}

bool names_picture(const std::string& kind) {
    return kind.ends_with(".exr") || kind.ends_with(".hdr");
}

/// A sky's text in front of the first colon, and the rest.
std::pair<std::string, std::string> split(const std::string& text) {
    const std::size_t colon = std::min(text.find(':'), text.size());
    return {text.substr(0, colon), text.substr(colon)};
}

/// How a picture of a sky is opened by its name.
using LoadPicture = std::function<SkyImage(const std::string& name)>;

/// For names that come from a file in this folder.
LoadPicture confined_to(const std::filesystem::path& folder) {
    return [folder](const std::string& name) {
        const auto inside = confined_path(folder, name);
        if (!inside)
            refuse("the picture of its sky, '" + name +
                   "', is outside its folder: name it with "
                   "--sky");
        return load_sky_image(*inside);
    };
}

Sky named_sky(const std::string& kind, const std::string& first, KeyValues& parts, const dvec3& up,
              const LoadPicture& load_picture) {
    if (kind == "none") return {};
    if (kind == "clear") return Sky::clear(up);
    if (kind == "color") return Sky::constant(parse_color(first));
    if (kind == "gradient") {
        const auto color = [&](const char* key) {
            const auto text = parts.take(key);
            if (!text) refuse(std::string("a gradient needs ") + key + "=R,G,B");
            return parse_color(*text);
        };
        const vec3 zenith = color("zenith"), horizon = color("horizon"), ground = color("ground");
        return Sky::gradient(zenith, horizon, ground, up);
    }
    if (!names_picture(kind))
        refuse("'" + kind + "' is not clear, none, color:, gradient: or a .exr or .hdr file");
    const auto turn = parts.take("turn");
    return Sky::image(load_picture(kind), up, turn ? number(*turn) * kRadiansPerDegree : 0.0);
}

Sky parse_sky(const std::string& text, const dvec3& up, const LoadPicture& load_picture) {
    auto [kind, rest] = split(text);
    if (!rest.empty()) rest.erase(0, 1);  // the colon
    std::string first;
    if (kind == "color") {
        const std::size_t end = rest.find(':');
        first = rest.substr(0, end);
        rest = end == std::string::npos ? "" : rest.substr(end + 1);
    }
    KeyValues parts(rest);
    const auto power = parts.take("power");
    const Sky sky = named_sky(kind, first, parts, up, load_picture);
    parts.check_all_taken("this sky");
    return power ? sky.scaled(static_cast<float>(parse_positive(*power))) : sky;
}

dmat4 placement_of(const JsonField& object) {
    dmat4 m(1.0);
    if (object.has("position")) m = glm::translate(m, object["position"].vector<dvec3>());
    if (object.has("rotation")) {
        const JsonField rotation = object["rotation"];
        rotation.check_keys({"axis", "degrees"});
        const dvec3 axis = rotation.has("axis") ? rotation["axis"].vector<dvec3>() : dvec3(0, 1, 0);
        if (!(glm::length(axis) > 0.0)) rotation["axis"].refuse("has no length");
        const double degrees = rotation.has("degrees") ? rotation["degrees"].number() : 0.0;
        m = glm::rotate(m, degrees * kRadiansPerDegree, glm::normalize(axis));
    }
    if (object.has("scale")) {
        const double scale = object["scale"].number();
        if (!(scale > 0.0)) object["scale"].refuse("is not above 0");
        m = glm::scale(m, dvec3(scale));
    }
    return m;
}

/// What there is to light.
Box lit_box(const Model& model) {
    return framed_box(model.dag, model.grid());
}

}  // namespace

std::filesystem::path sky_picture(const std::string& text) {
    const std::string kind = split(text).first;
    return names_picture(kind) ? kind : "";
}

Sky parse_sky(const std::string& text, const dvec3& up) {
    return parse_sky(text, up, [](const std::string& name) { return load_sky_image(name); });
}

std::string stored_sky(const std::string& text, const std::filesystem::path& file) {
    const auto [name, rest] = split(text);
    if (!names_picture(name)) return text;
    namespace fs = std::filesystem;
    const fs::path folder = fs::weakly_canonical(folder_of(file));
    return fs::weakly_canonical(name).lexically_proximate(folder).string() + rest;
}

bool is_stored_sky(const std::string& text, const std::string& stored,
                   const std::filesystem::path& file) {
    return text == stored || stored_sky(text, file) == stored;
}

Sky parse_stored_sky(const std::string& stored, const dvec3& up,
                     const std::filesystem::path& file) {
    try {
        return parse_sky(stored, up, confined_to(folder_of(file)));
    } catch (const Error& error) {
        if (error.code() != Errc::bad_argument) throw;
        throw Error(Errc::bad_input, file, error.what());
    }
}

namespace {

void read_objects(const JsonField& root, const std::filesystem::path& folder, SceneFile& file) {
    const std::vector<JsonField> objects = root["objects"].items();
    if (objects.empty()) root["objects"].refuse("is empty");
    if (objects.size() > kMostObjects)
        throw Error(Errc::limit, "/objects has more than " + std::to_string(kMostObjects));
    std::map<std::filesystem::path, Model> models;
    std::vector<Instance> instances;
    for (const JsonField& object : objects) {
        object.check_keys({"name", "file", "position", "rotation", "scale"});
        const std::string& name = object["file"].text();
        const auto inside = confined_path(folder, name);
        if (!inside) object["file"].refuse("is outside the scene's folder");
        const auto [known, is_new] = models.try_emplace(*inside);
        if (is_new) known->second = read_octv(*inside);
        const Model& model = known->second;
        file.models.push_back(model);
        file.scene.objects.push_back({.name = object.has("name") ? object["name"].text() : name,
                                      .dag = model.dag,
                                      .grid = model.grid(),
                                      .attributes = model.attributes,
                                      .placement = placement_of(object),
                                      .light = {}});
        instances.push_back({model.dag, model.grid(), file.scene.objects.back().placement});
    }
    (void)Instances(std::move(instances));  // what it refuses is refused here
}

Camera read_camera(const JsonField& camera, const dvec3& up) {
    camera.check_keys({"eye", "at", "fov"});
    const double degrees = camera.has("fov") ? camera["fov"].number() : kDefaultFovDegrees;
    return look_at(camera["eye"].vector<dvec3>(), camera["at"].vector<dvec3>(), up,
                   degrees * kRadiansPerDegree);
}

}  // namespace

SceneFile read_scene_file(const std::filesystem::path& path, const dvec3& up) {
    const FileBytes bytes = read_file(path, kMostSceneBytes);
    const std::filesystem::path folder = folder_of(path);
    SceneFile file;
    try {
        const JsonValue json = parse_json(bytes.view());
        const JsonField root(json, "");
        root.check_keys({"objects", "lights", "sky", "camera"});
        read_objects(root, folder, file);
        if (root.has("lights")) {
            std::vector<LightArgument> lights;
            for (const JsonField& light : root["lights"].items())
                lights.push_back(parse_light(light.text(), up));
            const Model& first = file.models.front();
            if (!lights.empty())
                file.lights = chosen_lights(lights, first.metadata.lights, lit_box(first));
        }
        file.scene.sky =
            parse_sky(root.has("sky") ? root["sky"].text() : "clear", up, confined_to(folder));
        if (root.has("camera")) file.camera = read_camera(root["camera"], up);
    } catch (const Error& error) {
        if (!error.file().empty()) throw;
        // What would be a mistake on the command line is one in the file.
        const bool argument = error.code() == Errc::bad_argument;
        throw Error(argument ? Errc::bad_input : error.code(), path, error.what());
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
