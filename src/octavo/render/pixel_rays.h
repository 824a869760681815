// SPDX-License-Identifier: MIT
#pragma once

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
    /// @param camera         its directions of any length, and not parallel
    /// @param width, height  of the picture, pixels
    PixelRays(const Camera& camera, const Grid& grid, int width, int height);

    /// Nothing of the grid can be seen: too far away and not in front. Rays have their directions
    /// then and no true origin: they are for an empty grid.
    [[nodiscard]] bool sees_nothing() const { return sees_nothing_; }

    /// How far the rays have travelled before their origin, in multiples of their direction.
    [[nodiscard]] float t_before() const { return view_.t_before; }

    /// Width of a pixel at depth 1.
    [[nodiscard]] float pixel_pitch() const { return static_cast<float>(pitch_); }

    /// The camera as the shared text wants it. Rays are those of camera_ray().
    [[nodiscard]] const shared::CameraView& view() const { return view_; }

    [[nodiscard]] shared::GridRay ray(int x, int y) const {
        return camera_ray(view_, {x, y}, vec2(0.5f));
    }

    /// The bundle of all rays through the pixels from (x0, y0) to before (x1, y1); none where rays
    /// start apart.
    [[nodiscard]] std::optional<shared::Bundle> bundle(int x0, int y0, int x1, int y1) const {
        if (view_.t_before > 0.0f) return std::nullopt;
        return camera_bundle(view_, {x0, y0}, {x1, y1});
    }

private:
    shared::CameraView view_;
    double pitch_;
    bool sees_nothing_ = false;
};

}  // namespace octavo
