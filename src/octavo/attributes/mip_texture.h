// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "octavo/core/vec.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// A picture in linear light at its own size and at halves of it, each texel the mean of those that
/// it covers. What is no part of the surface does not count: colours are multiplied by opacity,
/// which is 0 or 1 at full size.
///
/// Memory: 8 bytes for each pixel, and a third more.
class MipTexture {
public:
    /// @param least_alpha  alpha from which a pixel is part of the surface, 0 to 256; 0: all are
    MipTexture(const Texture& texture, int least_alpha);

    [[nodiscard]] int width() const { return levels_[0].width; }
    [[nodiscard]] int height() const { return levels_[0].height; }

    /// Linear light times opacity, and opacity; 0 to 1. Between texels it is linear.
    /// @param coordinate  (0, 0) is the picture's upper left corner, (1, 1) the lower right one
    /// @param level       log2 of the texels of the picture that a texel here is wide
    [[nodiscard]] vec4 sample(const glm::dvec2& coordinate, int level) const;

    /// The colour of the surface at the finest level that has any near this place; black where it
    /// is nothing but hole.
    [[nodiscard]] vec3 color_around(const glm::dvec2& coordinate) const;

private:
    using Texel = std::array<std::uint16_t, 4>;
    struct Level {
        int width = 0, height = 0;
        std::vector<Texel> texels;
    };
    [[nodiscard]] vec4 between_texels(const glm::dvec2& coordinate, const Level& level) const;

    std::vector<Level> levels_;
    Texture::Wrap wrap_u_, wrap_v_;
};

}  // namespace octavo
