// SPDX-License-Identifier: MIT
#include "octavo/mesh/texture_files.h"

#include <algorithm>
#include <string>

#include "octavo/mesh/confined_path.h"

namespace octavo {

int add_texture_file(Scene& scene, const std::filesystem::path& folder, std::string_view reference,
                     Texture::Wrap wrap_u, Texture::Wrap wrap_v) {
    const auto leave_out = [&](const std::string& why) {
        std::string warning = "texture '" + std::string(reference) + "' " + why + ": left out";
        if (std::find(scene.warnings.begin(), scene.warnings.end(), warning) ==
            scene.warnings.end())
            scene.warnings.push_back(std::move(warning));
        return Material::kNoTexture;
    };
    const auto file = confined_path(folder, reference);
    if (!file) return leave_out("is outside the scene's folder");
    std::error_code error;
    if (!std::filesystem::is_regular_file(*file, error)) return leave_out("is missing");

    const auto known =
        std::find_if(scene.textures.begin(), scene.textures.end(), [&](const Texture& texture) {
            return texture.file == *file && texture.wrap_u == wrap_u && texture.wrap_v == wrap_v;
        });
    if (known != scene.textures.end()) return static_cast<int>(known - scene.textures.begin());
    scene.textures.push_back({file->filename().string(), *file, {}, wrap_u, wrap_v});
    return static_cast<int>(scene.textures.size()) - 1;
}

int add_texture(Scene& scene, const std::filesystem::path& folder,
                const PictureReference& reference) {
    const std::string name(reference.name);
    if (name.empty()) return Material::kNoTexture;
    if (reference.encoded.empty()) return add_texture_file(scene, folder, name);
    const auto known = std::ranges::find_if(scene.textures, [&](const Texture& texture) {
        return texture.name == name && !texture.encoded.empty();
    });
    if (known != scene.textures.end()) return static_cast<int>(known - scene.textures.begin());
    scene.textures.push_back({name, {}, {reference.encoded.begin(), reference.encoded.end()}});
    return static_cast<int>(scene.textures.size()) - 1;
}

}  // namespace octavo
