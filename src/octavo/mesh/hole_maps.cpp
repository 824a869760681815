// SPDX-License-Identifier: MIT
#include "octavo/mesh/hole_maps.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <map>
#include <utility>

#include "octavo/mesh/alpha.h"

namespace octavo {

HoleMaps::HoleMaps(const Scene& scene) {
    if (std::none_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return m.alpha_cutoff.has_value(); }))
        return;

    constexpr std::uint32_t kUnknown = 0xfffffffdu;
    std::map<std::pair<int, int>, std::uint32_t> known;
    std::vector<std::uint32_t> maps_of(scene.triangles.size(), kNoHoles);
    bool any = false;
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        const int least = least_alpha(scene, t);
        if (least == 0) continue;
        const Texture* texture = decoded_texture(scene, material_of(scene, t).base_color_texture);
        if (scene.texture_coordinates.empty()) texture = nullptr;
        if (least > 255 || !texture) {
            // Without a texture alpha is 255 everywhere.
            maps_of[t] = least > 255 ? kAllHole : kNoHoles;
        } else {
            auto& map =
                known.emplace(std::pair(material_of(scene, t).base_color_texture, least), kUnknown)
                    .first->second;
            if (map == kUnknown) {
                OpacityMap made(*texture, least);
                map = made.all_solid() ? kNoHoles : static_cast<std::uint32_t>(maps_.size());
                if (map != kNoHoles) maps_.push_back(std::move(made));
                // Whatever decides where the holes are, for the journal's key.
                const auto& pixels = texture->picture->pixels;
                hash_ = XXH3_64bits_withSeed(pixels.data(), pixels.size() * sizeof(pixels[0]),
                                             hash_ + static_cast<unsigned>(least));
            }
            maps_of[t] = map;
        }
        any = any || maps_of[t] != kNoHoles;
    }
    if (!any) return;
    maps_of_ = std::move(maps_of);
    hash_ = XXH3_64bits_withSeed(maps_of_.data(), maps_of_.size() * sizeof(maps_of_[0]), hash_);
    hash_ = XXH3_64bits_withSeed(scene.texture_coordinates.data(),
                                 scene.texture_coordinates.size() * sizeof(vec2), hash_);
}

}  // namespace octavo
