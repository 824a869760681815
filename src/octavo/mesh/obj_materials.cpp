// SPDX-License-Identifier: MIT
//
// MTL, after the Alias|Wavefront description (1995) and what programs write today: Ke and Tr.
#include "octavo/mesh/obj_materials.h"

#include "octavo/core/file_bytes.h"
#include "octavo/mesh/confined_path.h"
#include "octavo/mesh/masked_texture.h"
#include "octavo/mesh/text_cursor.h"
#include "octavo/mesh/texture_files.h"

namespace octavo {
namespace {

constexpr std::uint64_t kMaxLibraryBytes = std::uint64_t{1} << 28;

/// One number, or three; what is not a number leaves the colour as it was.
vec3 read_color(TextCursor text, vec3 color) {
    double r = 0.0, g = 0.0, b = 0.0;
    text.skip_space();
    if (!text.number(r)) return color;
    text.skip_space();
    if (!text.number(g)) return vec3(static_cast<float>(r));
    text.skip_space();
    if (!text.number(b)) return color;
    return {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)};
}

/// The file name after a map's options, such as "-s 1 1 1 -clamp on bricks old.png".
std::string_view map_file(std::string_view text) {
    TextCursor words(text);
    for (;;) {
        TextCursor ahead = words;
        const std::string_view option = ahead.word();
        if (option.size() < 2 || option[0] != '-') break;
        if (option == "-o" || option == "-s" || option == "-t") {
            for (int i = 0; i < 3; ++i) {  // one to three numbers
                TextCursor next = ahead;
                TextCursor word(next.word());
                double ignored = 0.0;
                if (!word.number(ignored) || !word.done()) break;
                ahead = next;
            }
        } else {
            ahead.word();
            if (option == "-mm") ahead.word();
        }
        words = ahead;
    }
    return words.line();
}

}  // namespace

void read_obj_materials(const std::filesystem::path& file, Scene& scene,
                        std::map<std::string, std::uint32_t, std::less<>>& by_name) {
    const FileBytes bytes = read_file(file, kMaxLibraryBytes);
    const std::filesystem::path folder = folder_of(file);

    Material passed_over;  // of a name that is known already, and before the first name
    Material* material = &passed_over;
    std::string_view color_map, alpha_map;
    const auto finish = [&] {
        set_base_color_texture(scene, *material, folder, {color_map}, {alpha_map});
        color_map = alpha_map = {};
    };

    TextCursor text(bytes.view());
    while (!text.done()) {
        TextCursor words(text.line());
        const std::string_view keyword = words.word();
        const TextCursor rest = words;
        if (keyword == "newmtl") {
            finish();
            const std::string name(words.line());
            const auto index = static_cast<std::uint32_t>(scene.materials.size());
            material = &passed_over;
            if (by_name.emplace(name, index).second) {
                material = &scene.materials.emplace_back();
                material->name = name;
            }
        } else if (keyword == "Kd") {
            material->base_color =
                vec4(read_color(rest, vec3(material->base_color)), material->base_color.a);
        } else if (keyword == "Ke") {
            material->emission = read_color(rest, material->emission);
        } else if (keyword == "d") {
            material->base_color.a = read_color(rest, vec3(1.0f)).x;
        } else if (keyword == "Tr") {
            material->base_color.a = 1.0f - read_color(rest, vec3(0.0f)).x;
        } else if (keyword == "map_Kd") {
            color_map = map_file({rest.at, rest.end});
        } else if (keyword == "map_Ke") {
            material->emission_texture =
                add_texture_file(scene, folder, map_file({rest.at, rest.end}));
            if (material->emission == vec3(0.0f)) material->emission = vec3(1.0f);
        } else if (keyword == "map_d") {
            alpha_map = map_file({rest.at, rest.end});
        }
    }
    finish();
}

}  // namespace octavo
