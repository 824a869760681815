// SPDX-License-Identifier: MIT
#include "octavo/mesh/gltf_geometry.h"

#include "octavo/mesh/color.h"

namespace octavo::gltf {
namespace {

enum Mode { kTriangles = 4, kStrip, kFan };

constexpr std::uint64_t kVertexBytes = sizeof(dvec3) + 2 * sizeof(vec2) + 4;
constexpr std::uint64_t kTriangleBytes = sizeof(uvec3) + sizeof(std::uint32_t);

}  // namespace

dmat4 placement(const dvec4& translation, const dvec4& rotation, const dvec4& scale) {
    const dvec4 &t = translation, &s = scale;
    const double x = rotation.x, y = rotation.y, z = rotation.z, w = rotation.w;
    return {
        s.x * dvec4(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0),
        s.y * dvec4(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0),
        s.z * dvec4(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0),
        dvec4(t.x, t.y, t.z, 1),
    };
}

void GeometryReader::add_mesh(const json& mesh, const dmat4& world) {
    // Primitives often share one set of vertices and differ in their triangles only.
    VertexBases bases;
    const json* primitives = child(mesh, "primitives");
    if (!primitives) return;
    for (const json& primitive : *primitives) add_primitive(primitive, world, bases);
}

void GeometryReader::add_instances(const json& mesh, const json& instancing, const dmat4& world) {
    const json* attributes = child(instancing, "attributes");
    std::optional<std::size_t> count;
    const auto list = [&](const char* name, int components) {
        std::optional<Accessor> values;
        const auto index = attributes ? whole(*attributes, name) : std::nullopt;
        if (!index) return values;
        values = document_.accessor(*index);
        if (values->components != components || count.value_or(values->count) != values->count)
            throw document_.file().error("the instances' " + std::string(name) +
                                         " does not fit the others or its kind");
        count = values->count;
        return values;
    };
    const auto translations = list("TRANSLATION", 3);
    const auto rotations = list("ROTATION", 4);
    const auto scales = list("SCALE", 3);
    if (!count) return add_mesh(mesh, world);
    take_room(*count, sizeof(dmat4));  // though no place is kept: an empty mesh is not free either
    for (std::size_t i = 0; i < *count; ++i) {
        dvec4 rotation(0.0, 0.0, 0.0, 1.0);
        if (rotations) rotation = rotations->real(i);
        // Of integers, it is a unit quaternion only nearly.
        if (const double length = glm::length(rotation); length > 0.0) rotation /= length;
        add_mesh(mesh, world * placement(translations ? translations->real(i) : dvec4(0.0),
                                         rotation, scales ? scales->real(i) : dvec4(1.0)));
    }
}

std::size_t GeometryReader::finish() {
    if (!any_material_) scene_.triangle_materials = {};
    if (other_primitives_ != 0)
        warn(std::to_string(other_primitives_) + " sets of points or lines were passed over");
    return other_primitives_;
}

void GeometryReader::add_primitive(const json& primitive, const dmat4& world, VertexBases& bases) {
    const std::size_t mode = whole(primitive, "mode").value_or(kTriangles);
    if (mode < kTriangles || mode > kFan) {
        ++other_primitives_;
        return;
    }
    const json* attributes = child(primitive, "attributes");
    const auto position = attributes ? whole(*attributes, "POSITION") : std::nullopt;
    if (!position) return warn("primitives without positions were passed over");
    if (child(primitive, "targets")) warn("morph targets were passed over");
    const std::optional<Accessor> packed_triangles = document_.unpack_draco(primitive);
    const std::uint32_t material = material_of(primitive);
    const bool textured = material != Scene::kNoMaterial && !scene_.textures.empty();
    const MaterialPlacement placement = textured ? placements_[material] : MaterialPlacement{};
    const auto set_of = [&](const TexturePlacement& placed) {
        const std::string name = "TEXCOORD_" + std::to_string(placed.set);
        return whole(*attributes, name.c_str()).value_or(kNone);
    };
    const bool as_it_is =
        placement.base == TexturePlacement{} && placement.emission == TexturePlacement{};
    const VertexKey key{*position, set_of(placement.base), set_of(placement.emission),
                        whole(*attributes, "COLOR_0").value_or(kNone), as_it_is ? kNone : material};

    const Accessor positions = document_.accessor(*position);
    auto base = bases.find(key);
    if (base == bases.end())
        base = bases.emplace(key, add_vertices(positions, key, placement, world)).first;

    std::optional<Accessor> indices = packed_triangles;
    if (const auto index = whole(primitive, "indices"); index && !packed_triangles)
        indices = document_.accessor(*index);
    const std::size_t kind = packed_triangles ? std::size_t{kTriangles} : mode;
    add_triangles(kind, positions.count, indices ? &*indices : nullptr, base->second);
    scene_.triangle_materials.resize(scene_.triangles.size(), material);
}

std::uint32_t GeometryReader::material_of(const json& primitive) {
    const auto index = whole(primitive, "material");
    if (!index) return Scene::kNoMaterial;
    if (*index >= scene_.materials.size())
        throw document_.file().error("material " + std::to_string(*index) + " does not exist");
    any_material_ = true;
    return static_cast<std::uint32_t>(*index);
}

void GeometryReader::add_triangles(std::size_t mode, std::size_t vertices, const Accessor* indices,
                                   std::uint32_t base) {
    const std::size_t count = indices ? indices->count : vertices;
    const auto corner = [&](std::size_t i) {
        const std::uint64_t vertex = indices ? indices->index(i) : i;
        if (vertex >= vertices)
            throw document_.file().error("vertex " + std::to_string(vertex) + " of " +
                                         std::to_string(vertices) + " does not exist");
        return base + static_cast<std::uint32_t>(vertex);
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
}

std::uint32_t GeometryReader::add_vertices(const Accessor& positions, const VertexKey& key,
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
    if (!scene_.textures.empty()) add_coordinates(key, placement, base);
    add_colors(std::get<3>(key), base);
    return static_cast<std::uint32_t>(base);
}

void GeometryReader::add_coordinates(const VertexKey& key, const MaterialPlacement& placement,
                                     std::size_t base) {
    const std::size_t end = scene_.positions.size();
    const auto append = [&](std::size_t accessor, const TexturePlacement& placed,
                            std::vector<vec2>& target) {
        target.resize(base);
        if (accessor == kNone) return target.resize(end);
        const Accessor source = attribute(accessor, end - base);
        for (std::size_t i = 0; i < end - base; ++i)
            target.push_back(placed.apply(glm::dvec2(source.real(i))));
    };
    const std::size_t texture = std::get<1>(key), emission = std::get<2>(key);
    auto& coordinates = scene_.texture_coordinates;
    auto& of_emission = scene_.emission_coordinates;
    const bool apart = emission != kNone && !(placement.base == placement.emission);
    if (texture != kNone || apart || !coordinates.empty())
        append(texture, placement.base, coordinates);
    if (apart) {
        if (of_emission.empty()) of_emission.assign(coordinates.begin(), coordinates.end());
        append(emission, placement.emission, of_emission);
    } else if (!of_emission.empty()) {
        of_emission.insert(of_emission.end(),
                           coordinates.begin() + static_cast<std::ptrdiff_t>(base),
                           coordinates.end());
    }
}

void GeometryReader::add_colors(std::size_t accessor, std::size_t base) {
    const std::size_t end = scene_.positions.size();
    auto& colors = scene_.colors;
    if (accessor == kNone) {
        if (!colors.empty()) colors.resize(end, kWhite);
        return;
    }
    const Accessor source = attribute(accessor, end - base);
    colors.resize(base, kWhite);
    for (std::size_t i = 0; i < end - base; ++i) {
        const dvec4 c = source.real(i);
        colors.push_back({unit_to_byte(c.x), unit_to_byte(c.y), unit_to_byte(c.z),
                          source.components == 4 ? unit_to_byte(c.w) : kWhite[3]});
    }
}

Accessor GeometryReader::attribute(std::size_t accessor, std::size_t vertices) {
    Accessor found = document_.accessor(accessor);
    if (found.count < vertices)
        throw document_.file().error("an attribute has fewer elements than its positions");
    return found;
}

void GeometryReader::take_room(std::uint64_t elements, std::uint64_t bytes_each) {
    bytes_ += elements * bytes_each;  // a step is below 2^40: no sum passes 2^64
    if (bytes_ > max_bytes_)
        throw Error(Errc::limit, document_.file().file(),
                    "with all instances, takes more than " + std::to_string(max_bytes_) + " bytes");
}

}  // namespace octavo::gltf
