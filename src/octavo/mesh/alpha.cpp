// SPDX-License-Identifier: MIT
#include "octavo/mesh/alpha.h"

#include <algorithm>
#include <cmath>

namespace octavo {

const Material& plain_material(bool corners_have_colors) {
    static const Material white;
    static const Material clay = [] {
        Material material;
        material.base_color = {0.78f, 0.76f, 0.72f, 1.0f};  // as light/shade.h has it
        return material;
    }();
    return corners_have_colors ? white : clay;
}

const Material& material_of(const Scene& scene, std::size_t triangle) {
    const Material& plain = plain_material(!scene.colors.empty());
    if (scene.triangle_materials.empty()) return plain;
    const std::uint32_t index = scene.triangle_materials[triangle];
    return index < scene.materials.size() ? scene.materials[index] : plain;
}

const Texture* decoded_texture(const Scene& scene, int texture) {
    if (texture < 0 || static_cast<std::size_t>(texture) >= scene.textures.size()) return nullptr;
    const Texture& found = scene.textures[static_cast<std::size_t>(texture)];
    return found.picture ? &found : nullptr;
}

int least_alpha(const Scene& scene, std::size_t triangle) {
    std::uint8_t alpha = 255;
    if (!scene.colors.empty()) {
        const uvec3& t = scene.triangles[triangle];
        const auto corner = [&](std::uint32_t vertex) { return scene.colors[vertex][3]; };
        alpha = std::max({corner(t.x), corner(t.y), corner(t.z)});
    }
    return least_alpha(material_of(scene, triangle), alpha);
}

int least_alpha(const Material& material, std::uint8_t corner_alpha) {
    if (!material.alpha_cutoff || !(*material.alpha_cutoff > 0.0f)) return 0;
    const float alpha = material.base_color.a * (static_cast<float>(corner_alpha) / 255.0f);
    // alpha * byte / 255 >= cutoff
    const float least = std::ceil(*material.alpha_cutoff * 255.0f / alpha - 1e-4f);
    return least <= 255.0f ? std::max(0, static_cast<int>(least)) : 256;
}

}  // namespace octavo
