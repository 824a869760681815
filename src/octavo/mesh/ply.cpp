// SPDX-License-Identifier: MIT
//
// PLY, after Greg Turk's description of the Stanford format (1994). Our own reader because scans
// are the largest meshes there are: it makes one pass and keeps nothing but the scene.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "octavo/mesh/color.h"
#include "octavo/mesh/formats.h"
#include "octavo/mesh/ply_header.h"
#include "octavo/mesh/text_cursor.h"
#include "octavo/mesh/triangulate.h"

namespace octavo {
namespace {

using namespace ply;

/// The data of an ASCII file as a row of numbers. Line ends are blanks like others: some writers
/// break long lists.
class TextValues {
public:
    static constexpr bool kIsText = true;

    TextValues(const FileBytes& bytes, const char* body)
        : bytes_(bytes), text_(body, bytes.view().data() + bytes.view().size()) {}

    [[nodiscard]] const char* at() const { return text_.at; }
    [[nodiscard]] std::size_t remaining() const {
        // The last number needs nothing after it.
        return static_cast<std::size_t>(text_.end - text_.at) + 1;
    }

    double real(Type) {
        text_.skip_space();
        double value = 0.0;
        if (!text_.number(value)) throw missing();
        return value;
    }

    std::int64_t integer(Type) {
        text_.skip_space();
        const TextCursor start = text_;
        long long value = 0;
        if (text_.number(value) && (text_.done() || TextCursor::is_space(*text_.at))) return value;
        text_ = start;  // "3.0"
        const double number = real(Type::f64);
        if (!(std::abs(number) < 0x1p53)) throw bytes_.error_at(start.at, "is not an index");
        return static_cast<std::int64_t>(number);
    }

private:
    [[nodiscard]] Error missing() const {
        return bytes_.error_at(
            text_.at, text_.done() ? "the file ends too early" : "a number was expected here");
    }

    const FileBytes& bytes_;
    TextCursor text_;
};

/// The data of a binary file.
template <std::endian kOrder>
class BinaryValues {
public:
    static constexpr bool kIsText = false;

    BinaryValues(const FileBytes& bytes, const char* body)
        : bytes_(bytes), at_(body), end_(bytes.view().data() + bytes.view().size()) {}

    [[nodiscard]] const char* at() const { return at_; }
    [[nodiscard]] std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }

    double real(Type type) {
        switch (type) {
            case Type::f32:
                return take<float>();
            case Type::f64:
                return take<double>();
            default:
                return static_cast<double>(integer(type));
        }
    }

    std::int64_t integer(Type type) {
        switch (type) {
            case Type::i8:
                return take<std::int8_t>();
            case Type::u8:
                return take<std::uint8_t>();
            case Type::i16:
                return take<std::int16_t>();
            case Type::u16:
                return take<std::uint16_t>();
            case Type::i32:
                return take<std::int32_t>();
            case Type::u32:
                return take<std::uint32_t>();
            default:
                break;
        }
        const char* start = at_;
        const double number = real(type);
        if (!(std::abs(number) < 0x1p53)) throw bytes_.error_at(start, "is not an index");
        return static_cast<std::int64_t>(number);
    }

    void skip(std::size_t size) {
        if (remaining() < size) throw bytes_.error_at(at_, "the file ends too early");
        at_ += size;
    }

private:
    template <class T>
    T take() {
        std::array<char, sizeof(T)> raw;
        const char* start = at_;
        skip(sizeof(T));
        std::memcpy(raw.data(), start, sizeof(T));
        if constexpr (kOrder != std::endian::native) std::reverse(raw.begin(), raw.end());
        return std::bit_cast<T>(raw);
    }

    const FileBytes& bytes_;
    const char* at_;
    const char* end_;
};

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
    if constexpr (Values::kIsText) {
        for (; count > 0; --count) values.real(property.type);
    } else if (count > 0) {
        const std::size_t room = values.remaining() / size_of(property.type) + 1;
        values.skip(std::min<std::size_t>(static_cast<std::size_t>(count), room) *
                    size_of(property.type));
    }
}

template <class Values>
void read_vertices(const Element& element, Values& values, const FileBytes& bytes, Scene& scene) {
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
        throw bytes.error_at(element.where, "the vertices have no x, y and z");
    const bool has_color = has[kRed] && has[kGreen] && has[kBlue];
    const bool has_texture = has[kU] && has[kV];

    scene.positions.reserve(element.count);
    if (has_color) scene.colors.reserve(element.count);
    if (has_texture) scene.texture_coordinates.reserve(element.count);

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
void read_faces(const Element& element, bool strips, Values& values, const FileBytes& bytes,
                Scene& scene) {
    const auto is_index_list = [](const Property& p) {
        return p.count_type && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    for (const Property& property : element.properties)
        if (is_index_list(property) && !is_whole(property.type))
            throw bytes.error_at(element.where, "the indices of vertices are not whole numbers");
    const std::size_t vertex_count = scene.positions.size();
    // A face has one triangle in nearly all files; strips have one per index or so.
    if (!strips) scene.triangles.reserve(element.count);

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
                const char* where = values.at();
                const std::int64_t index = values.integer(property.type);
                if (strips && index == -1) {
                    finish();
                    continue;
                }
                if (index < 0 || static_cast<std::uint64_t>(index) >= vertex_count)
                    throw bytes.error_at(where, "vertex " + std::to_string(index) + " of " +
                                                    std::to_string(vertex_count) +
                                                    " does not exist");
                corners.push_back(static_cast<std::uint32_t>(index));
            }
            finish();
        }
    }
    if (scene.triangles.size() > 0xffffffffull)
        throw Error(Errc::limit, bytes.file(), "has more than 2^32 triangles");
}

template <class Values>
Scene read_body(const Header& header, const FileBytes& bytes) {
    Scene scene;
    Values values(bytes, header.body);
    for (const Element& element : header.elements) {
        // Elements without properties have no bytes.
        const std::size_t min_bytes = element.min_bytes(header.format);
        if (min_bytes == 0) continue;
        if (element.count > values.remaining() / min_bytes)
            throw bytes.error_at(element.where, "the header announces " +
                                                    std::to_string(element.count) + " of '" +
                                                    std::string(element.name) +
                                                    "', more than the file has room for");
        if (element.name == "vertex") {
            if (element.count > Scene::kNoMaterial)
                throw Error(Errc::limit, bytes.file(), "has more than 2^32 vertices");
            if (!scene.positions.empty())
                throw bytes.error_at(element.where, "a second list of vertices");
            read_vertices(element, values, bytes, scene);
        } else if (element.name == "face") {
            read_faces(element, false, values, bytes, scene);
        } else if (element.name == "tristrips") {
            read_faces(element, true, values, bytes, scene);
        } else {
            for (std::uint64_t i = 0; i < element.count; ++i)
                for (const Property& property : element.properties) skip_property(property, values);
        }
    }
    return scene;
}

}  // namespace

Scene formats::read_ply(const FileBytes& bytes) {
    const Header header = read_header(bytes);
    switch (header.format) {
        case Format::ascii:
            return read_body<TextValues>(header, bytes);
        case Format::little_endian:
            return read_body<BinaryValues<std::endian::little>>(header, bytes);
        default:
            return read_body<BinaryValues<std::endian::big>>(header, bytes);
    }
}

}  // namespace octavo
