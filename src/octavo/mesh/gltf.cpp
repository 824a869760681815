// SPDX-License-Identifier: MIT
//
// glTF 2.0: walks the nodes, in double; adds cameras and lights, and has meshes added.
#include <set>
#include <string>
#include <vector>

#include "octavo/mesh/child_process.h"
#include "octavo/mesh/formats.h"
#include "octavo/mesh/gltf_document.h"
#include "octavo/mesh/gltf_geometry.h"
#include "octavo/mesh/gltf_materials.h"

namespace octavo {
namespace {

using namespace gltf;

dmat4 local_matrix(const json& node) {
    if (const json* values = child(node, "matrix")) {
        dmat4 matrix(1.0);
        for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = values->at(i).get<double>();
        return matrix;
    }
    return placement(numbers(node, "translation", dvec4(0.0)),
                     numbers(node, "rotation", dvec4(0.0, 0.0, 0.0, 1.0)),
                     numbers(node, "scale", dvec4(1.0)));
}

/// The unit vector of this direction; the fallback where a matrix has flattened it.
dvec3 unit(const dvec4& direction, const dvec3& fallback) {
    const double length = glm::length(dvec3(direction));
    return length > 0.0 ? dvec3(direction) / length : fallback;
}

class SceneReader {
public:
    SceneReader(Document& document, std::uint64_t max_bytes)
        : document_(document),
          geometry_(document_, scene_, read_materials(document_, scene_), warnings_, max_bytes) {}

    Scene read() {
        check_extensions();
        walk_nodes();
        const std::size_t points_or_lines = geometry_.finish();
        if (scene_.triangles.empty() && points_or_lines != 0)
            throw formats::only_points_or_lines(document_.file().file());
        for (const std::string& warning : warnings_) scene_.warnings.push_back(warning);
        return std::move(scene_);
    }

private:
    void warn(const std::string& what) { warnings_.insert(what); }

    void check_extensions() {
        static const std::set<std::string> known{"EXT_mesh_gpu_instancing",
                                                 "EXT_meshopt_compression",
                                                 "KHR_draco_mesh_compression",
                                                 "KHR_lights_punctual",
                                                 "KHR_materials_emissive_strength",
                                                 "KHR_materials_pbrSpecularGlossiness",
                                                 "KHR_mesh_quantization",
                                                 "KHR_meshopt_compression",
                                                 "KHR_texture_transform"};
        const json* required = child(document_.root(), "extensionsRequired");
        if (!required) return;
        for (const json& value : *required) {
            const auto name = value.get<std::string>();
            if (!known.contains(name)) warn("requires " + name + ", which is not known");
        }
    }

    std::vector<std::size_t> root_nodes() const {
        std::vector<std::size_t> roots;
        if (document_.count("scenes") > 0) {
            const json& scene =
                document_.object("scenes", whole(document_.root(), "scene").value_or(0));
            if (const json* nodes = child(scene, "nodes"))
                for (const json& node : *nodes) roots.push_back(as_whole(node));
            return roots;
        }
        // A file without scenes shows all of it: every node that is nobody's child.
        std::set<std::size_t> children;
        for (std::size_t i = 0; i < document_.count("nodes"); ++i)
            if (const json* below = child(document_.object("nodes", i), "children"))
                for (const json& node : *below) children.insert(as_whole(node));
        for (std::size_t i = 0; i < document_.count("nodes"); ++i)
            if (!children.contains(i)) roots.push_back(i);
        return roots;
    }

    void walk_nodes() {
        struct Visit {
            std::size_t node;
            dmat4 parent;
        };
        std::vector<Visit> open;
        const auto roots = root_nodes();
        for (auto root = roots.rbegin(); root != roots.rend(); ++root)
            open.push_back({*root, dmat4(1.0)});
        std::vector<bool> seen(document_.count("nodes"));
        while (!open.empty()) {
            const Visit visit = open.back();
            open.pop_back();
            const json& node = document_.object("nodes", visit.node);
            // Nodes form trees; one that is met again would be a cycle, or cost exponential time.
            if (seen[visit.node])
                throw document_.file().error("node " + std::to_string(visit.node) +
                                             " has two parents");
            seen[visit.node] = true;
            const dmat4 world = visit.parent * local_matrix(node);
            add_node(node, world);
            if (const json* below = child(node, "children"))
                for (auto i = below->size(); i-- > 0;)
                    open.push_back({as_whole(below->at(i)), world});
        }
    }

    void add_node(const json& node, const dmat4& world) {
        if (const auto mesh = whole(node, "mesh")) {
            if (child(node, "skin")) warn("skinned meshes are taken in their bind pose");
            const json& shown = document_.object("meshes", *mesh);
            if (const json* instances = extension(node, "EXT_mesh_gpu_instancing"))
                geometry_.add_instances(shown, *instances, world);
            else
                geometry_.add_mesh(shown, world);
        }
        if (const auto camera = whole(node, "camera"))
            add_camera(document_.object("cameras", *camera), node, world);
        if (const json* light = extension(node, "KHR_lights_punctual"))
            add_light(whole(*light, "light").value_or(0), node, world);
    }

    static std::string name_of(const json& object, const json& node) {
        auto name = value_or<std::string>(object, "name", "");
        return name.empty() ? value_or<std::string>(node, "name", "") : name;
    }

    void add_camera(const json& source, const json& node, const dmat4& world) {
        const json* perspective = child(source, "perspective");
        if (!perspective) return warn("orthographic cameras were passed over");
        Camera camera;
        camera.name = name_of(source, node);
        camera.eye = dvec3(world[3]);
        camera.forward = unit(-world[2], camera.forward);
        camera.up = unit(world[1], camera.up);
        camera.vertical_fov = value_or(*perspective, "yfov", camera.vertical_fov);
        scene_.cameras.push_back(std::move(camera));
    }

    void add_light(std::size_t index, const json& node, const dmat4& world) {
        const json* all = extension(document_.root(), "KHR_lights_punctual");
        const json* lights = all ? child(*all, "lights") : nullptr;
        if (!lights || index >= lights->size())
            throw document_.file().error("light " + std::to_string(index) + " does not exist");
        const json& source = lights->at(index);

        Light light;
        light.name = name_of(source, node);
        light.position = dvec3(world[3]);
        light.direction = unit(-world[2], light.direction);
        light.intensity =
            vec3(numbers(source, "color", dvec4(1.0)) * value_or(source, "intensity", 1.0));
        const auto type = value_or<std::string>(source, "type", "");
        if (type == "point") {
            light.kind = Light::Kind::point;
        } else if (type == "spot") {
            light.kind = Light::Kind::spot;
            if (const json* spot = child(source, "spot")) {
                light.inner_angle = value_or(*spot, "innerConeAngle", light.inner_angle);
                light.outer_angle = value_or(*spot, "outerConeAngle", light.outer_angle);
            }
        } else if (type != "directional") {
            return warn("a light of unknown type '" + type + "' was passed over");
        }
        scene_.lights.push_back(std::move(light));
    }

    Document& document_;
    Scene scene_;
    std::set<std::string> warnings_;
    GeometryReader geometry_;
};

/// The library's words without the number that it puts before them.
std::string without_code(const json::exception& error) {
    const std::string text = error.what();
    const std::size_t code = text.find("] ");
    return code == std::string::npos ? text : text.substr(code + 2);
}

}  // namespace

Scene formats::read_gltf(const FileBytes& bytes, std::uint64_t max_bytes, double max_seconds) {
    Document document(bytes, max_bytes);
    const auto read = [&] {
        try {
            return SceneReader(document, max_bytes).read();
        } catch (const json::exception& error) {
            throw bytes.error("is not valid glTF: " + without_code(error));
        }
    };
    return document.names(kDraco) ? read_in_child(bytes.file(), read, max_bytes, max_seconds)
                                  : read();
}

}  // namespace octavo
