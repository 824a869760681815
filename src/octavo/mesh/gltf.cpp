// SPDX-License-Identifier: MIT
//
// glTF 2.0: walks the nodes, in double, and adds what hangs on them to the scene.
#include <array>
#include <map>
#include <set>
#include <tuple>

#include "octavo/mesh/color.h"
#include "octavo/mesh/formats.h"
#include "octavo/mesh/gltf_document.h"
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
    const dvec4 t = numbers(node, "translation", dvec4(0.0));
    const dvec4 q = numbers(node, "rotation", dvec4(0.0, 0.0, 0.0, 1.0));
    const dvec4 s = numbers(node, "scale", dvec4(1.0));
    const double x = q.x, y = q.y, z = q.z, w = q.w;
    return {
        s.x * dvec4(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0),
        s.y * dvec4(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0),
        s.z * dvec4(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0),
        dvec4(t.x, t.y, t.z, 1),
    };
}

/// The unit vector of this direction; the fallback where a matrix has flattened it.
dvec3 unit(const dvec4& direction, const dvec3& fallback) {
    const double length = glm::length(dvec3(direction));
    return length > 0.0 ? dvec3(direction) / length : fallback;
}

class SceneReader {
public:
    SceneReader(const FileBytes& bytes, std::uint64_t max_bytes)
        : document_(bytes, max_bytes), max_bytes_(max_bytes) {}

    Scene read() {
        check_extensions();
        placements_ = read_materials(document_, scene_);
        walk_nodes();
        if (scene_.triangles.empty() && other_primitives_ != 0)
            throw formats::only_points_or_lines(document_.file().file());
        if (!any_material_) scene_.triangle_materials = {};
        if (other_primitives_ != 0)
            warn(std::to_string(other_primitives_) + " sets of points or lines were passed over");
        for (const std::string& warning : warnings_) scene_.warnings.push_back(warning);
        return std::move(scene_);
    }

private:
    void warn(const std::string& what) { warnings_.insert(what); }

    void check_extensions() {
        // Geometry that is packed so that we cannot read it.
        static const std::set<std::string> packed{"KHR_draco_mesh_compression",
                                                  "EXT_meshopt_compression"};
        static const std::set<std::string> known{
            "KHR_mesh_quantization", "KHR_lights_punctual", "KHR_materials_emissive_strength",
            "KHR_texture_transform", "KHR_materials_pbrSpecularGlossiness"};
        const json* required = child(document_.root(), "extensionsRequired");
        if (!required) return;
        for (const json& value : *required) {
            const auto name = value.get<std::string>();
            if (packed.contains(name))
                throw Error(Errc::unsupported, document_.file().file(),
                            "needs " + name + ": unpack it first");
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
            if (extension(node, "EXT_mesh_gpu_instancing"))
                warn("EXT_mesh_gpu_instancing is not known: each such mesh is taken once");
            add_mesh(document_.object("meshes", *mesh), world);
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

    void add_mesh(const json& mesh, const dmat4& world) {
        // Primitives often share one set of vertices and differ in their triangles only.
        VertexBases bases;
        const json* primitives = child(mesh, "primitives");
        if (!primitives) return;
        for (const json& primitive : *primitives) add_primitive(primitive, world, bases);
    }

    /// Position, texture coordinate, emission coordinate and colour accessor, and the material
    /// where it places its textures in a way of its own.
    using VertexKey = std::tuple<std::size_t, std::size_t, std::size_t, std::size_t, std::size_t>;
    using VertexBases = std::map<VertexKey, std::uint32_t>;
    static constexpr std::size_t kNone = ~std::size_t{0};

    void add_primitive(const json& primitive, const dmat4& world, VertexBases& bases) {
        enum Mode { kTriangles = 4, kStrip, kFan };
        const std::size_t mode = whole(primitive, "mode").value_or(kTriangles);
        if (mode < kTriangles || mode > kFan) {
            ++other_primitives_;
            return;
        }
        const json* attributes = child(primitive, "attributes");
        const auto position = attributes ? whole(*attributes, "POSITION") : std::nullopt;
        if (!position) return warn("primitives without positions were passed over");
        if (child(primitive, "targets")) warn("morph targets were passed over");
        if (extension(primitive, "KHR_draco_mesh_compression"))
            warn("Draco data was passed over for the plain data beside it");

        std::uint32_t material = Scene::kNoMaterial;
        if (const auto index = whole(primitive, "material")) {
            if (*index >= scene_.materials.size())
                throw document_.file().error("material " + std::to_string(*index) +
                                             " does not exist");
            material = static_cast<std::uint32_t>(*index);
            any_material_ = true;
        }
        const bool textured = material != Scene::kNoMaterial && !scene_.textures.empty();
        const MaterialPlacement placement = textured ? placements_[material] : MaterialPlacement{};
        const auto set_of = [&](const TexturePlacement& placed) {
            const std::string name = "TEXCOORD_" + std::to_string(placed.set);
            return whole(*attributes, name.c_str()).value_or(kNone);
        };
        const bool as_it_is =
            placement.base == TexturePlacement{} && placement.emission == TexturePlacement{};
        const VertexKey key{*position, set_of(placement.base), set_of(placement.emission),
                            whole(*attributes, "COLOR_0").value_or(kNone),
                            as_it_is ? kNone : material};

        const Accessor positions = document_.accessor(*position);
        auto base = bases.find(key);
        if (base == bases.end())
            base = bases.emplace(key, add_vertices(positions, key, placement, world)).first;

        std::optional<Accessor> indices;
        if (const auto index = whole(primitive, "indices")) indices = document_.accessor(*index);
        const std::size_t count = indices ? indices->count : positions.count;
        const auto corner = [&](std::size_t i) {
            const std::uint64_t vertex = indices ? indices->index(i) : i;
            if (vertex >= positions.count)
                throw document_.file().error("vertex " + std::to_string(vertex) + " of " +
                                             std::to_string(positions.count) + " does not exist");
            return base->second + static_cast<std::uint32_t>(vertex);
        };
        take_room(count / 3 * (mode == kTriangles ? 1 : 3), kTriangleBytes);
        auto& triangles = scene_.triangles;
        if (mode == kTriangles) {
            if (count % 3 != 0) warn("a list of triangles has corners left over");
            triangles.reserve(triangles.size() + count / 3);
            for (std::size_t i = 0; i + 2 < count; i += 3)
                triangles.emplace_back(corner(i), corner(i + 1), corner(i + 2));
        } else {
            for (std::size_t i = 2; i < count; ++i) {
                const std::size_t odd = i & 1;  // every other triangle of a strip is turned
                if (mode == kStrip)
                    triangles.emplace_back(corner(i - 2 + odd), corner(i - 1 - odd), corner(i));
                else
                    triangles.emplace_back(corner(0), corner(i - 1), corner(i));
            }
        }
        if (triangles.size() > 0xffffffffull)
            throw Error(Errc::limit, document_.file().file(), "has more than 2^32 triangles");
        scene_.triangle_materials.resize(triangles.size(), material);
    }

    std::uint32_t add_vertices(const Accessor& positions, const VertexKey& key,
                               const MaterialPlacement& placement, const dmat4& world) {
        const std::size_t base = scene_.positions.size();
        if (positions.components != 3)
            throw document_.file().error("positions are not three numbers each");
        if (positions.count > Scene::kNoMaterial - base)
            throw Error(Errc::limit, document_.file().file(), "has more than 2^32 vertices");

        take_room(positions.count, kVertexBytes);
        for (std::size_t i = 0; i < positions.count; ++i) {
            const dvec4 p = positions.real(i);
            scene_.positions.emplace_back(world * dvec4(p.x, p.y, p.z, 1.0));
        }
        const auto [position, texture, emission, color, placed_by] = key;
        const auto attribute = [&](std::size_t index) {
            Accessor accessor = document_.accessor(index);
            if (accessor.count < positions.count)
                throw document_.file().error("an attribute has fewer elements than its positions");
            return accessor;
        };
        const auto add_coordinates = [&](std::size_t accessor, const TexturePlacement& placed,
                                         std::vector<vec2>& target) {
            target.resize(base);
            if (accessor == kNone) return target.resize(scene_.positions.size());
            const Accessor source = attribute(accessor);
            for (std::size_t i = 0; i < positions.count; ++i)
                target.push_back(placed.apply(glm::dvec2(source.real(i))));
        };
        auto& coordinates = scene_.texture_coordinates;
        auto& of_emission = scene_.emission_coordinates;
        const bool apart = !(placement.base == placement.emission);
        const bool any = texture != kNone || (apart && emission != kNone);
        if (!scene_.textures.empty() && (any || !coordinates.empty()))
            add_coordinates(texture, placement.base, coordinates);
        if (!scene_.textures.empty() && apart && emission != kNone) {
            if (of_emission.empty())
                of_emission.assign(coordinates.begin(),
                                   coordinates.begin() + static_cast<std::ptrdiff_t>(base));
            add_coordinates(emission, placement.emission, of_emission);
        } else if (!of_emission.empty()) {
            of_emission.insert(of_emission.end(),
                               coordinates.begin() + static_cast<std::ptrdiff_t>(base),
                               coordinates.end());
        }
        if (color != kNone) {
            const Accessor source = attribute(color);
            scene_.colors.resize(base, kWhite);
            for (std::size_t i = 0; i < positions.count; ++i) {
                const dvec4 c = source.real(i);
                scene_.colors.push_back({unit_to_byte(c.x), unit_to_byte(c.y), unit_to_byte(c.z),
                                         source.components == 4 ? unit_to_byte(c.w) : kWhite[3]});
            }
        } else if (!scene_.colors.empty()) {
            scene_.colors.resize(scene_.positions.size(), kWhite);
        }
        return static_cast<std::uint32_t>(base);
    }

    static constexpr std::uint64_t kVertexBytes = sizeof(dvec3) + 2 * sizeof(vec2) + 4;
    static constexpr std::uint64_t kTriangleBytes = sizeof(uvec3) + sizeof(std::uint32_t);

    /// Nodes may use one mesh any number of times, so a short file can describe any size.
    void take_room(std::uint64_t elements, std::uint64_t bytes_each) {
        bytes_ += elements * bytes_each;  // a step is below 2^40: no sum passes 2^64
        if (bytes_ > max_bytes_)
            throw Error(
                Errc::limit, document_.file().file(),
                "with all instances, takes more than " + std::to_string(max_bytes_) + " bytes");
    }

    Document document_;
    std::uint64_t max_bytes_;
    std::uint64_t bytes_ = 0;
    Scene scene_;
    std::vector<MaterialPlacement> placements_;
    std::set<std::string> warnings_;
    std::size_t other_primitives_ = 0;
    bool any_material_ = false;
};

/// The library's words without the number that it puts before them.
std::string without_code(const json::exception& error) {
    const std::string text = error.what();
    const std::size_t code = text.find("] ");
    return code == std::string::npos ? text : text.substr(code + 2);
}

}  // namespace

Scene formats::read_gltf(const FileBytes& bytes, std::uint64_t max_bytes) {
    try {
        return SceneReader(bytes, max_bytes).read();
    } catch (const json::exception& error) {
        throw bytes.error("is not valid glTF: " + without_code(error));
    }
}

}  // namespace octavo
