// SPDX-License-Identifier: MIT
//
// PLY, after Greg Turk's description of the Stanford format (1994). Our own reader because scans
// are the largest meshes there are: it makes one pass and keeps nothing but the scene.
#include <algorithm>
#include <array>
#include <string>

#include "octavo/mesh/color.h"
#include "octavo/mesh/formats.h"
#include "octavo/mesh/ply_header.h"
#include "octavo/mesh/ply_values.h"
#include "octavo/mesh/triangulate.h"

namespace octavo {
namespace {

using namespace ply;

/// What a property of a vertex is to us.
enum Role { kX, kY, kZ, kRed, kGreen, kBlue, kAlpha, kU, kV, kRoles };

Role role_of(std::string_view name) {
    struct Name {
        std::string_view name;
        Role role;
    };
    constexpr Name kNames[] = {
        {"x", kX},         {"y", kY},
        {"z", kZ},         {"red", kRed},
        {"green", kGreen}, {"blue", kBlue},
        {"alpha", kAlpha}, {"diffuse_red", kRed},
        {"r", kRed},       {"diffuse_green", kGreen},
        {"g", kGreen},     {"diffuse_blue", kBlue},
        {"b", kBlue},      {"diffuse_alpha", kAlpha},
        {"a", kAlpha},     {"s", kU},
        {"t", kV},         {"u", kU},
        {"v", kV},         {"texture_u", kU},
        {"texture_v", kV},
    };
    for (const Name& known : kNames)
        if (name == known.name) return known.role;
    return kRoles;
}

/// The number that means full brightness.
double full_scale(Type type) {
    switch (type) {
        case Type::f32:
        case Type::f64:
            return 1.0;
        case Type::i16:
        case Type::u16:
            return 65535.0;
        default:
            return 255.0;
    }
}

template <class Values>
void skip_property(const Property& property, Values& values) {
    std::int64_t count = 1;
    if (property.count_type) count = values.integer(*property.count_type);
    if (count > 0) values.skip(static_cast<std::uint64_t>(count), property.type);
}

template <class Values>
void read_vertices(const Element& element, std::uint64_t likely_count, Values& values,
                   const FileWindow& input, Scene& scene) {
    std::array<bool, kRoles + 1> has{};
    std::vector<Role> roles;
    std::array<double, kRoles + 1> scale{};
    scale.fill(1.0);
    for (const Property& property : element.properties) {
        const Role role = property.count_type ? kRoles : role_of(property.name);
        roles.push_back(role);
        has[role] = true;
        if (role >= kRed && role <= kAlpha) scale[role] = 1.0 / full_scale(property.type);
    }
    if (!has[kX] || !has[kY] || !has[kZ])
        throw input.error_at(element.where, "the vertices have no x, y and z");
    const bool has_color = has[kRed] && has[kGreen] && has[kBlue];
    const bool has_texture = has[kU] && has[kV];

    scene.positions.reserve(likely_count);
    if (has_color) scene.colors.reserve(likely_count);
    if (has_texture) scene.texture_coordinates.reserve(likely_count);

    std::array<double, kRoles + 1> value{};
    value[kAlpha] = 1.0;
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (std::size_t p = 0; p < roles.size(); ++p) {
            const Property& property = element.properties[p];
            if (roles[p] == kRoles)
                skip_property(property, values);
            else
                value[roles[p]] = values.real(property.type) * scale[roles[p]];
        }
        scene.positions.emplace_back(value[kX], value[kY], value[kZ]);
        if (has_color)
            scene.colors.push_back({unit_to_byte(value[kRed]), unit_to_byte(value[kGreen]),
                                    unit_to_byte(value[kBlue]), unit_to_byte(value[kAlpha])});
        // PLY's texture coordinates, like OBJ's, start at the picture's lower left corner.
        if (has_texture) scene.texture_coordinates.emplace_back(value[kU], 1.0 - value[kV]);
    }
}

void add_strip(std::span<const std::uint32_t> strip, std::vector<uvec3>& triangles) {
    for (std::size_t i = 2; i < strip.size(); ++i) {
        const std::size_t odd = i & 1;  // every other triangle of a strip turns the other way
        triangles.emplace_back(strip[i - 2 + odd], strip[i - 1 - odd], strip[i]);
    }
}

/// Faces are polygons; a strip is one long list in which -1 begins the next strip.
template <class Values>
void read_faces(const Element& element, std::uint64_t likely_count, bool strips, Values& values,
                const FileWindow& input, Scene& scene) {
    const auto is_index_list = [](const Property& p) {
        return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    for (const Property& property : element.properties)
        if (is_index_list(property) && !is_whole(property.type))
            throw input.error_at(element.where, "the indices of vertices are not whole numbers");
    const std::size_t vertex_count = scene.positions.size();
    // A face has one triangle in nearly all files; strips have one per index or so.
    if (!strips) scene.triangles.reserve(likely_count);

    std::vector<std::uint32_t> corners;
    const auto finish = [&] {
        if (strips)
            add_strip(corners, scene.triangles);
        else
            triangulate(scene.positions, corners, scene.triangles);
        corners.clear();
    };
    for (std::uint64_t i = 0; i < element.count; ++i) {
        for (const Property& property : element.properties) {
            if (!is_index_list(property)) {
                skip_property(property, values);
                continue;
            }
            std::int64_t count = values.integer(*property.count_type);
            for (; count > 0; --count) {
                const std::int64_t index = values.integer(property.type);
                if (strips && index == -1) {
                    finish();
                    continue;
                }
                if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count)
                    throw input.error_at(values.latest(),
                                         "vertex " + std::to_string(index) + " of " +
                                             std::to_string(vertex_count) + " does not exist");
                corners.push_back(static_cast<std::uint32_t>(index));
            }
            finish();
        }
    }
    if (scene.triangles.size() > 0xffffffffull)
        throw Error(Errc::limit, input.file(), "has more than 2^32 triangles");
}

template <class Values>
Scene read_body(const Header& header, FileWindow& input) {
    Scene scene;
    Values values(input);
    for (const Element& element : header.elements) {
        // Elements without properties have no bytes.
        const std::size_t min_bytes = element.min_bytes(header.format);
        if (min_bytes == 0) continue;
        if (element.count > values.most_ahead() / min_bytes)
            throw input.error_at(element.where,
                                 "the header announces " + std::to_string(element.count) + " of '" +
                                     element.name + "', more than the file has room for");
        const std::uint64_t likely_count =
            std::min(element.count, values.expected_ahead() / min_bytes);
        if (element.name == "vertex") {
            if (element.count > Scene::kNoMaterial)
                throw Error(Errc::limit, input.file(), "has more than 2^32 vertices");
            if (!scene.positions.empty())
                throw input.error_at(element.where, "a second list of vertices");
            read_vertices(element, likely_count, values, input, scene);
        } else if (element.name == "face") {
            read_faces(element, likely_count, false, values, input, scene);
        } else if (element.name == "tristrips") {
            read_faces(element, likely_count, true, values, input, scene);
        } else {
            for (std::uint64_t i = 0; i < element.count; ++i)
                for (const Property& property : element.properties) skip_property(property, values);
        }
    }
    return scene;
}

}  // namespace

Scene formats::read_ply(FileWindow& input) {
    const Header header = read_header(input);
    switch (header.format) {
        case Format::ascii:
            return read_body<TextValues>(header, input);
        case Format::little_endian:
            return read_body<BinaryValues<std::endian::little>>(header, input);
        default:
            return read_body<BinaryValues<std::endian::big>>(header, input);
    }
}

}  // namespace octavo
