// SPDX-License-Identifier: MIT
//
// Wavefront OBJ. Our own reader because tinyobjloader adds up a number's digits one by one: its
// doubles are a few units in the last place off, which at 5.7e6 metres shows.
#include <map>
#include <numeric>
#include <string>

#include "octavo/mesh/alpha.h"
#include "octavo/mesh/color.h"
#include "octavo/mesh/confined_path.h"
#include "octavo/mesh/formats.h"
#include "octavo/mesh/line_reader.h"
#include "octavo/mesh/obj_materials.h"
#include "octavo/mesh/text_cursor.h"
#include "octavo/mesh/triangulate.h"

namespace octavo {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

/// A line may go on after a backslash, which between numbers is then a blank like any other.
void skip_between_numbers(TextCursor& text) {
    while (!text.done() && (TextCursor::is_space(*text.at) || *text.at == '\\')) ++text.at;
}

bool goes_on(std::string_view line) {
    while (!line.empty() && TextCursor::is_space(line.back())) line.remove_suffix(1);
    return line.ends_with('\\');
}

class ObjReader {
public:
    explicit ObjReader(FileWindow& input) : lines_(input) {}

    Scene read() {
        std::string_view line;
        for (bool first = true; lines_.next(line); first = false) {
            while (goes_on(line))
                if (!lines_.extend(line)) break;
            read_line(first ? without_byte_order_mark(line) : line);
        }
        resolve_materials();
        resolve_texture_coordinates();
        if (short_faces_ != 0)
            scene_.warnings.push_back(std::to_string(short_faces_) +
                                      " faces with fewer than three corners were passed over");
        if (lost_texture_coordinates_)
            scene_.warnings.push_back("some faces refer to texture coordinates that do not exist");
        return std::move(scene_);
    }

private:
    struct Corner {
        std::uint32_t vertex;
        std::uint32_t texture;
    };

    void read_line(std::string_view line) {
        TextCursor words(line);
        const std::string_view keyword = words.word();
        if (keyword == "v")
            read_vertex(words);
        else if (keyword == "f")
            read_face(words);
        else if (keyword == "vt")
            read_texture_coordinate(words);
        else if (keyword == "usemtl")
            use_material(words.line());
        else if (keyword == "mtllib")
            read_library(words.line());
        // Groups, smoothing, normals, points, lines and curves say nothing about where surfaces
        // are.
    }

    void read_vertex(TextCursor& text) {
        if (scene_.positions.size() == kNone)
            throw Error(Errc::limit, lines_.file(), "has more than 2^32 vertices");
        double value[8];
        int count = 0;
        for (; count < 8; ++count) {
            skip_between_numbers(text);
            if (!text.number(value[count])) break;
        }
        if (count < 3) throw lines_.error_at(text.at, "a vertex needs three coordinates");
        scene_.positions.emplace_back(value[0], value[1], value[2]);

        // x y z red green blue [alpha]; a lone fourth number is a weight, which polygons ignore.
        auto& colors = scene_.colors;
        if (count >= 6) {
            colors.resize(scene_.positions.size() - 1, kWhite);
            colors.push_back({unit_to_byte(value[3]), unit_to_byte(value[4]),
                              unit_to_byte(value[5]),
                              count > 6 ? unit_to_byte(value[6]) : kWhite[3]});
        } else if (!colors.empty()) {
            colors.push_back(kWhite);
        }
    }

    void read_texture_coordinate(TextCursor& text) {
        double u = 0.0, v = 0.0;
        skip_between_numbers(text);
        text.number(u);
        skip_between_numbers(text);
        text.number(v);
        // OBJ counts v from the picture's lower edge.
        texture_coordinates_.emplace_back(u, 1.0 - v);
    }

    /// An index counts from 1, or back from the latest one where it is negative.
    static std::uint32_t resolve(long long index, std::size_t count) {
        if (index > 0 && static_cast<std::size_t>(index) <= count)
            return static_cast<std::uint32_t>(index - 1);
        if (index < 0 && static_cast<std::size_t>(-(index + 1)) < count)
            return static_cast<std::uint32_t>(static_cast<long long>(count) + index);
        return kNone;
    }

    /// "7", "7/3", "7/3/2", "7//2"
    bool read_corner(TextCursor& text, Corner& corner) {
        skip_between_numbers(text);
        if (text.done() || *text.at == '#') return false;
        const char* where = text.at;
        long long vertex = 0;
        if (!text.number(vertex)) throw lines_.error_at(where, "a vertex index was expected here");
        corner = {resolve(vertex, scene_.positions.size()), kNone};
        if (corner.vertex == kNone)
            throw lines_.error_at(where, "vertex " + std::to_string(vertex) + " of " +
                                             std::to_string(scene_.positions.size()) +
                                             " does not exist");
        if (text.done() || *text.at != '/') return true;
        ++text.at;
        long long texture = 0;
        if (text.number(texture)) {
            corner.texture = resolve(texture, texture_coordinates_.size());
            if (corner.texture == kNone) lost_texture_coordinates_ = true;
        }
        while (!text.done() && !TextCursor::is_space(*text.at)) ++text.at;  // the normal
        return true;
    }

    void read_face(TextCursor& text) {
        corners_.clear();
        Corner corner{};
        while (read_corner(text, corner)) corners_.push_back(corner);
        if (corners_.size() < 3) {
            ++short_faces_;
            return;
        }
        local_triangles_.clear();
        if (corners_.size() == 3) {
            local_triangles_.emplace_back(0, 1, 2);
        } else {
            local_positions_.clear();
            for (const Corner& c : corners_) local_positions_.push_back(scene_.positions[c.vertex]);
            local_indices_.resize(corners_.size());
            std::iota(local_indices_.begin(), local_indices_.end(), 0u);
            triangulate(local_positions_, local_indices_, local_triangles_);
        }
        for (const uvec3& t : local_triangles_)
            add_triangle(corners_[t.x], corners_[t.y], corners_[t.z]);
    }

    /// Scans have neither texture coordinates nor materials: their lists begin with the first one.
    void add_triangle(const Corner& a, const Corner& b, const Corner& c) {
        const std::size_t before = scene_.triangles.size();
        scene_.triangles.emplace_back(a.vertex, b.vertex, c.vertex);
        if ((a.texture & b.texture & c.texture) != kNone) {
            triangle_textures_.resize(before, uvec3(kNone));
            triangle_textures_.emplace_back(a.texture, b.texture, c.texture);
        }
        if (!used_names_.empty()) scene_.triangle_materials.push_back(material_);
    }

    /// Until the end, triangle_materials are indices of names: a library may follow their use.
    void use_material(std::string_view name) {
        if (used_names_.empty())
            scene_.triangle_materials.assign(scene_.triangles.size(), Scene::kNoMaterial);
        const auto next = static_cast<std::uint32_t>(used_names_.size());
        material_ = used_names_.emplace(name, next).first->second;
    }

    void read_library(std::string_view names) {
        const std::filesystem::path folder = folder_of(lines_.file());
        const auto file_of = [&](std::string_view name) {
            if (auto file = confined_path(folder, name)) return *file;
            throw lines_.error_at(names.data(), "the material library '" + std::string(name) +
                                                    "' is outside the scene's folder");
        };
        const auto read_if_there = [&](std::string_view name) {
            const std::filesystem::path file = file_of(name);
            std::error_code error;
            if (!std::filesystem::is_regular_file(file, error)) return false;
            read_obj_materials(file, scene_, materials_);
            return true;
        };
        // One name that may have blanks in it, or several names.
        if (names.empty() || read_if_there(names)) return;
        TextCursor words(names);
        for (std::string_view name = words.word(); !name.empty(); name = words.word())
            if (!read_if_there(name))
                scene_.warnings.push_back("the material library '" + std::string(name) +
                                          "' is missing");
    }

    void resolve_materials() {
        if (used_names_.empty()) return;
        // A name alone still tells surfaces apart, but says nothing of their colour.
        Material unknown = plain_material(!scene_.colors.empty());
        std::size_t undefined = 0;
        std::vector<std::uint32_t> index_of(used_names_.size());
        for (const auto& [name, use] : used_names_) {
            const auto next = static_cast<std::uint32_t>(scene_.materials.size());
            const auto [found, is_new] = materials_.emplace(name, next);
            index_of[use] = found->second;
            if (!is_new) continue;
            unknown.name = name;
            scene_.materials.push_back(unknown);
            ++undefined;
        }
        if (undefined != 0)
            scene_.warnings.push_back(std::to_string(undefined) +
                                      " materials have a name but no definition");
        for (std::uint32_t& material : scene_.triangle_materials)
            if (material != Scene::kNoMaterial) material = index_of[material];
    }

    /// A vertex with two texture coordinates becomes two vertices. Done only where a texture needs
    /// it.
    void resolve_texture_coordinates() {
        if (scene_.textures.empty() || texture_coordinates_.empty()) return;
        struct Use {
            std::uint32_t texture = kNone;
            std::uint32_t next = kNone;  // another vertex at the same position
        };
        triangle_textures_.resize(scene_.triangles.size(), uvec3(kNone));
        std::vector<Use> uses(scene_.positions.size());
        std::vector<bool> used(scene_.positions.size());
        const auto vertex_for = [&](std::uint32_t vertex, std::uint32_t texture) {
            if (!used[vertex]) {
                used[vertex] = true;
                uses[vertex].texture = texture;
                return vertex;
            }
            for (;;) {
                if (uses[vertex].texture == texture) return vertex;
                if (uses[vertex].next == kNone) break;
                vertex = uses[vertex].next;
            }
            const auto added = static_cast<std::uint32_t>(scene_.positions.size());
            if (added == kNone) throw Error(Errc::limit, lines_.file(), "has too many vertices");
            scene_.positions.push_back(dvec3(scene_.positions[vertex]));
            if (!scene_.colors.empty()) scene_.colors.push_back(Rgba8(scene_.colors[vertex]));
            uses[vertex].next = added;
            uses.push_back({texture, kNone});
            used.push_back(true);
            return added;
        };
        for (std::size_t i = 0; i < scene_.triangles.size(); ++i)
            for (int c = 0; c < 3; ++c)
                scene_.triangles[i][c] =
                    vertex_for(scene_.triangles[i][c], triangle_textures_[i][c]);

        scene_.texture_coordinates.reserve(uses.size());
        for (const Use& use : uses)
            scene_.texture_coordinates.push_back(
                use.texture == kNone ? vec2(0.0f) : texture_coordinates_[use.texture]);
    }

    LineReader lines_;
    Scene scene_;
    std::vector<vec2> texture_coordinates_;
    std::vector<uvec3> triangle_textures_;
    std::map<std::string, std::uint32_t, std::less<>> materials_;
    std::map<std::string, std::uint32_t, std::less<>> used_names_;
    std::uint32_t material_ = Scene::kNoMaterial;
    std::size_t short_faces_ = 0;
    bool lost_texture_coordinates_ = false;

    std::vector<Corner> corners_;
    std::vector<dvec3> local_positions_;
    std::vector<std::uint32_t> local_indices_;
    std::vector<uvec3> local_triangles_;
};

}  // namespace

Scene formats::read_obj(FileWindow& input) {
    return ObjReader(input).read();
}

}  // namespace octavo
