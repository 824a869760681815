// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "octavo/mesh/gltf_document.h"
#include "octavo/mesh/scene.h"

namespace octavo::gltf {

/// Where a material's picture lies on a surface: which set of coordinates, moved how
/// (KHR_texture_transform).
struct TexturePlacement {
    std::size_t set = 0;
    glm::dvec2 offset{0.0};
    glm::dvec2 scale{1.0};
    double rotation = 0.0;

    [[nodiscard]] vec2 apply(const glm::dvec2& coordinate) const;
    friend bool operator==(const TexturePlacement&, const TexturePlacement&) = default;
};

/// Where the pictures of a material lie. Of one that has one picture both are alike.
struct MaterialPlacement {
    TexturePlacement base, emission;
};

/// Adds the document's materials and the textures that they use to the scene, in the document's
/// order. @return the placement of each material's textures
std::vector<MaterialPlacement> read_materials(Document& document, Scene& scene);

}  // namespace octavo::gltf
