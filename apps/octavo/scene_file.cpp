// SPDX-License-Identifier: MIT
#include "scene_file.h"

#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <utility>

#include "camera_path.h"
#include "degrees.h"
#include "light_arguments.h"
#include "octavo/core/file_bytes.h"
#include "octavo/io/json_field.h"
#include "octavo/io/octv.h"
#include "octavo/mesh/confined_path.h"
#include "octavo/render/render.h"
#include "octavo/trace/instances.h"
#include "sky_arguments.h"

namespace octavo::cli {
namespace {

constexpr std::uint64_t kMostSceneBytes = 16u << 20;
constexpr std::size_t kMostObjects = 10'000;

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
                file.lights = chosen_lights(lights, first.metadata.lights,
                                            framed_box(first.dag, first.grid()));
        }
        file.scene.sky =
            parse_confined_sky(root.has("sky") ? root["sky"].text() : "clear", up, folder);
        if (root.has("camera")) {
            root["camera"].check_keys({"eye", "at", "fov"});
            const CameraPath::Key camera = read_camera_key(root["camera"]);
            file.camera = look_at(camera.eye, camera.at, up, camera.vertical_fov);
        }
    } catch (const Error& error) {
        if (!error.file().empty()) throw;
        // What would be a mistake on the command line is one in the file.
        const bool argument = error.code() == Errc::bad_argument;
        throw Error(argument ? Errc::bad_input : error.code(), path, error.what());
    }
    return file;
}

}  // namespace octavo::cli
