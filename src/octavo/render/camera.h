// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "octavo/core/grid.h"
#include "octavo/mesh/scene.h"
#include "octavo/render/effects.h"

namespace octavo {

/// A camera's rays through the pixels of a picture, in grid space. All rays have the same length
/// along the view direction, so that time is depth in voxels, minus `t_before`.
///
/// Near the grid, all start in one point, as beams need. A camera that is too far for whole numbers
/// starts each ray at its own point of a plane before the grid.
class PixelRays {
public:
    PixelRays(const Camera& camera, const Grid& grid, int width, int height);

    /// Nothing of the grid can be seen: too far away and not in front.
    [[nodiscard]] bool sees_nothing() const { return sees_nothing_; }

    /// How far the rays have travelled before their origin, in multiples of their direction.
    [[nodiscard]] float t_before() const { return static_cast<float>(t_before_); }

    /// Width of a pixel at depth 1.
    [[nodiscard]] float pixel_pitch() const { return static_cast<float>(pitch_); }

    /// The direction of the point (x, y) of the picture in pixels, y downwards; world and grid
    /// space.
    [[nodiscard]] dvec3 direction(double x, double y) const {
        return forward_ + (x * pitch_ - half_width_) * right_ + (half_height_ - y * pitch_) * up_;
    }

    [[nodiscard]] shared::GridRay ray(double x, double y) const;

    /// The bundle of all rays through the pixels [x0, x1] x [y0, y1]; none where rays start apart.
    [[nodiscard]] std::optional<shared::Bundle> bundle(int x0, int y0, int x1, int y1) const;

private:
    dvec3 forward_, right_, up_, eye_;  // eye_: grid space
    double pitch_, half_width_, half_height_;
    double t_before_ = 0.0;
    bool sees_nothing_ = false;
};

}  // namespace octavo
