// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "octavo/mesh/scene.h"

namespace octavo {

/// Which pixels of a texture are no hole, so that it can be asked of any rectangle of them.
class OpacityMap {
public:
    /// @param texture      decoded
    /// @param least_alpha  alpha from which a pixel is no hole
    OpacityMap(const Texture& texture, int least_alpha);

    /// Of the pixels from `first` to `last`, which may lie beyond the edges, are there any that are
    /// no hole, and any that are?
    struct Found {
        bool solid = false;
        bool hole = false;
    };
    using Pixel = std::array<std::int64_t, 2>;
    [[nodiscard]] Found find(const Pixel& first, const Pixel& last) const;

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] bool all_solid() const { return levels_.back().nodes[0] == kSolid; }

private:
    static constexpr std::uint8_t kSolid = 1, kHole = 2;  // what a square of pixels holds
    struct Level {
        int width, height;
        std::vector<std::uint8_t> nodes;

        [[nodiscard]] std::size_t index(int x, int y) const {
            return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x);
        }
    };
    [[nodiscard]] std::uint8_t find_in(int level, int x, int y, const std::array<int, 4>& range,
                                       std::uint8_t found) const;

    int width_, height_;
    Texture::Wrap wrap_u_, wrap_v_;
    std::vector<Level> levels_;  // from the pixels to a single node, each half as wide
};

}  // namespace octavo
