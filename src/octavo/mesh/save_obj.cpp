// SPDX-License-Identifier: MIT
#include <cstring>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "octavo/core/file_bytes.h"
#include "octavo/mesh/confined_path.h"
#include "octavo/mesh/output_file.h"
#include "octavo/mesh/png.h"
#include "octavo/mesh/save_formats.h"

namespace octavo {
namespace {

/// Names without blanks, each once; the last one is for triangles without a material.
std::vector<std::string> material_names(const Scene& scene) {
    std::vector<std::string> names;
    std::set<std::string> taken;
    const auto add = [&](std::string name) {
        for (char& c : name)
            if (static_cast<unsigned char>(c) <= ' ') c = '_';
        if (name.empty()) name = "material";
        std::string unique = name;
        for (int i = 2; !taken.insert(unique).second; ++i) unique = name + "_" + std::to_string(i);
        names.push_back(std::move(unique));
    };
    for (const Material& material : scene.materials) add(material.name);
    add("none");
    return names;
}

void write_color(OutputFile& out, const char* keyword, const vec3& color) {
    out.write(keyword);
    for (int c = 0; c < 3; ++c) {
        out.write(" ");
        out.write_number(color[c]);
    }
    out.write("\n");
}

/// The extension that a picture's bytes call for.
const char* extension_of(std::span<const std::byte> picture) {
    const auto begins_with = [&](std::string_view magic) {
        return picture.size() >= magic.size() &&
               std::memcmp(picture.data(), magic.data(), magic.size()) == 0;
    };
    return begins_with("\x89PNG") ? ".png" : begins_with("\xff\xd8") ? ".jpg" : ".tga";
}

/// The textures that materials name, as paths from the folder of the OBJ file.
class TextureNames {
public:
    TextureNames(const Scene& scene, const std::filesystem::path& file)
        : scene_(scene), file_(file), folder_(folder_of(file)), names_(scene.textures.size()) {}

    /// A picture that is not in a file of this folder or below gets one beside the OBJ file.
    const std::string& name(int texture) {
        const auto index = static_cast<std::size_t>(texture);
        std::string& name = names_[index];
        if (!name.empty()) return name;
        const Texture& of = scene_.textures[index];
        if (!of.file.empty() && is_inside(folder_, of.file)) {
            name = std::filesystem::relative(of.file, folder_).generic_string();
        } else if (!of.file.empty()) {
            const FileBytes bytes = read_file(of.file, kMaxPictureBytes);
            name = write(index, std::as_bytes(std::span(bytes.view())));
        } else if (!of.encoded.empty()) {
            name = write(index, of.encoded);
        } else if (of.picture) {
            const Bitmap& picture = *of.picture;
            const auto* pixels = reinterpret_cast<const std::uint8_t*>(picture.pixels.data());
            name = write(index, encode_png({pixels, 4 * picture.pixels.size()}, picture.width,
                                           picture.height, PngChannels::rgba));
        }
        return name;
    }

private:
    [[nodiscard]] std::string write(std::size_t index, std::span<const std::byte> bytes) const {
        std::filesystem::path beside = file_;
        beside.replace_extension();
        beside += "-";
        beside += std::to_string(index) + extension_of(bytes);
        OutputFile out(beside);
        out.write(bytes.data(), bytes.size());
        out.commit();
        return beside.filename().string();
    }

    const Scene& scene_;
    const std::filesystem::path& file_;
    std::filesystem::path folder_;
    std::vector<std::string> names_;
};

void write_materials(const Scene& scene, const std::vector<std::string>& names,
                     const std::filesystem::path& file) {
    OutputFile out(file);
    TextureNames textures(scene, file);
    const auto write_map = [&](const char* keyword, int texture) {
        if (texture < 0 || static_cast<std::size_t>(texture) >= scene.textures.size()) return false;
        const std::string& name = textures.name(texture);
        if (name.empty()) return false;
        out.write(std::string(keyword) + " " + name + "\n");
        return true;
    };
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& material = scene.materials[i];
        out.write("newmtl " + names[i] + "\n");
        write_color(out, "Kd", vec3(material.base_color));
        if (material.emission != vec3(0.0f)) write_color(out, "Ke", material.emission);
        if (material.base_color.a != 1.0f) {
            out.write("d ");
            out.write_number(material.base_color.a);
            out.write("\n");
        }
        if (write_map("map_Kd", material.base_color_texture) && material.alpha_cutoff)
            write_map("map_d", material.base_color_texture);
        write_map("map_Ke", material.emission_texture);
        out.write("\n");
    }
    out.write("newmtl " + names.back() + "\n");
    write_color(out, "Kd", vec3(1.0f));
    out.commit();
}

void write_vertices(OutputFile& out, const Scene& scene) {
    for (std::size_t i = 0; i < scene.positions.size(); ++i) {
        out.write("v");
        for (int axis = 0; axis < 3; ++axis) {
            out.write(" ");
            out.write_number(scene.positions[i][axis]);
        }
        if (!scene.colors.empty()) {
            for (int channel = 0; channel < 3; ++channel) {
                out.write(" ");
                out.write_number(static_cast<float>(scene.colors[i][channel]) / 255.0f);
            }
        }
        out.write("\n");
    }
    for (const vec2& coordinate : scene.texture_coordinates) {
        out.write("vt ");
        out.write_number(coordinate.x);
        out.write(" ");
        out.write_number(1.0f - coordinate.y);  // OBJ counts from the picture's lower edge
        out.write("\n");
    }
}

/// @param names  of the materials, and one for triangles without
void write_faces(OutputFile& out, const Scene& scene, const std::vector<std::string>& names) {
    const bool has_materials = !scene.triangle_materials.empty();
    const bool has_texture = !scene.texture_coordinates.empty();
    std::uint32_t current = Scene::kNoMaterial;
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
        if (has_materials && (i == 0 || scene.triangle_materials[i] != current)) {
            current = scene.triangle_materials[i];
            const bool none = current == Scene::kNoMaterial;
            out.write("usemtl " + (none ? names.back() : names[current]) + "\n");
        }
        out.write("f");
        for (int c = 0; c < 3; ++c) {
            const std::uint64_t index = std::uint64_t{scene.triangles[i][c]} + 1;
            out.write(" ");
            out.write_number(index);
            if (has_texture) {
                out.write("/");
                out.write_number(index);
            }
        }
        out.write("\n");
    }
}

}  // namespace

void formats::write_obj(const Scene& scene, const std::filesystem::path& file) {
    const std::vector<std::string> names = material_names(scene);
    OutputFile out(file);
    if (!scene.triangle_materials.empty()) {
        std::filesystem::path library = file;
        library.replace_extension(".mtl");
        write_materials(scene, names, library);
        out.write("mtllib " + library.filename().string() + "\n");
    }
    write_vertices(out, scene);
    write_faces(out, scene, names);
    out.commit();
}

}  // namespace octavo
