// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "octavo/render/pixel_rays.h"
#include "octavo/render/render.h"
#include "octavo/render/visibility.h"

namespace octavo {

/// RenderOptions as every backend takes them: checked, with all that was left open decided, in grid
/// space.
struct RenderSettings {
    PixelRays rays;
    std::vector<Light> lights;
    vec3 up;          // unit length
    float ao_radius;  // voxels
    shared::Stop primary_stop;
    shared::Stop ao_stop;
    dvec3 eye;  // world space
    Box lit;    // what there is to light, world space
};

/// @throws Error  bad_argument where an option is out of range or not finite
void check(const RenderOptions& options);

/// The camera of a picture: the one that is asked for, or default_camera() of the box.
/// @throws Error  bad_argument where the camera that is asked for is none, see look_along()
[[nodiscard]] Camera picture_camera(const RenderOptions& options, const Box& framed);

/// @throws Error  bad_argument where check() does, or the camera is none
[[nodiscard]] RenderSettings settle(const Dag& dag, const Grid& grid, const RenderOptions& options);

/// The lengths of the arrays of visibility(), and its options.
/// @throws Error  bad_argument where visibility() does
void check(const VisibilityOptions& options, std::size_t points, std::size_t normals,
           std::size_t shadow, std::size_t ambient);

/// The part of a pixel's `count` rays that sample i of `samples` shoots: [first, end).
[[nodiscard]] inline ivec2 share(int count, int samples, int i) {
    const int each = (count + samples - 1) / samples;
    return {i * each, (i + 1) * each};
}

}  // namespace octavo
