// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/mesh/png.h"
#include "octavo/mesh/scene.h"

namespace octavo::test {

/// A square of 16 x 16 units that is a hole where its checkerboard is black.
inline Scene holed_square() {
    constexpr int kSide = 7;
    std::vector<std::uint8_t> pixels;
    for (int i = 0; i < kSide * kSide; ++i) {
        pixels.insert(pixels.end(), 3, 200);
        pixels.push_back(i % 2 == 0 ? 255 : 0);
    }
    Scene scene;
    scene.positions = {{0, 0, 3.3}, {16, 0, 3.3}, {16, 16, 3.3}, {0, 16, 3.3}};
    scene.texture_coordinates = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    scene.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene.triangle_materials = {0, 0};
    Material material;
    material.name = "grid";
    material.base_color_texture = 0;
    material.alpha_cutoff = 0.5f;
    scene.materials.push_back(material);
    Texture texture;
    texture.name = "checkerboard";
    texture.encoded = encode_png(pixels, kSide, kSide, PngChannels::rgba);
    scene.textures.push_back(texture);
    return scene;
}

}  // namespace octavo::test
