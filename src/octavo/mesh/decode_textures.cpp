// SPDX-License-Identifier: MIT
#include "octavo/mesh/decode_textures.h"

#include <tbb/parallel_for.h>

#include <new>
#include <string>

#include "octavo/core/error.h"
#include "octavo/mesh/file_bytes.h"

namespace octavo {
namespace {

Bitmap decode(const Texture& texture) {
    if (texture.file.empty()) return decode_bitmap(texture.encoded);
    const FileBytes bytes = read_file(texture.file);
    return decode_bitmap(std::as_bytes(std::span(bytes.view())));
}

}  // namespace

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
        Texture& texture = scene.textures[i];
        if (!used[i] || texture.picture) return;
        const auto leave_out = [&](const std::string& why) {
            const std::string name = texture.name.empty() ? std::to_string(i) : texture.name;
            warnings[i] = "texture '" + name + "' " + why + ": left out";
        };
        try {
            texture.picture = std::make_shared<const Bitmap>(decode(texture));
        } catch (const Error& error) {
            leave_out(error.what());
        } catch (const std::bad_alloc&) {
            leave_out("does not fit into memory");
        }
    });
    for (std::string& warning : warnings)
        if (!warning.empty()) scene.warnings.push_back(std::move(warning));
}

}  // namespace octavo
