// SPDX-License-Identifier: MIT
#include "octavo/mesh/decode_textures.h"

#include <tbb/parallel_for.h>

#include <new>
#include <string>

#include "octavo/core/error.h"
#include "octavo/core/file_bytes.h"

namespace octavo {
namespace {

Bitmap decode(const Texture& texture) {
    if (texture.file.empty()) return decode_bitmap(texture.encoded);
    const FileBytes bytes = read_file(texture.file, kMaxPictureBytes);
    return decode_bitmap(std::as_bytes(std::span(bytes.view())));
}

}  // namespace

std::shared_ptr<const Bitmap> decoded_picture(const Scene& scene, int index, std::string& warning) {
    const Texture& texture = scene.textures[static_cast<std::size_t>(index)];
    if (texture.picture) return texture.picture;
    const auto leave_out = [&](const std::string& why) {
        const std::string name = texture.name.empty() ? std::to_string(index) : texture.name;
        warning = "texture '" + name + "' " + why + ": left out";
        return nullptr;
    };
    try {
        return std::make_shared<const Bitmap>(decode(texture));
    } catch (const Error& error) {
        return leave_out(error.what());
    } catch (const std::bad_alloc&) {
        return leave_out("does not fit into memory");
    }
}

void decode_textures(Scene& scene, WantedTextures wanted) {
    std::vector<bool> used(scene.textures.size());
    const auto use = [&](int texture) {
        if (texture >= 0 && static_cast<std::size_t>(texture) < used.size())
            used[static_cast<std::size_t>(texture)] = true;
    };
    for (const Material& material : scene.materials) {
        const bool all = wanted == WantedTextures::all;
        if (all || material.alpha_cutoff) use(material.base_color_texture);
        if (all) use(material.emission_texture);
    }

    std::vector<std::string> warnings(used.size());
    tbb::parallel_for(std::size_t{0}, used.size(), [&](std::size_t i) {
        if (!used[i] || scene.textures[i].picture) return;
        scene.textures[i].picture = decoded_picture(scene, static_cast<int>(i), warnings[i]);
    });
    for (std::string& warning : warnings)
        if (!warning.empty()) scene.warnings.push_back(std::move(warning));
}

}  // namespace octavo
