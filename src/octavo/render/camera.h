// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/core/box.h"
#include "octavo/core/vec.h"
#include "octavo/mesh/scene.h"

/// Cameras and suns by where they stand and look; world space, angles in radians. All throw Error
/// bad_argument where `up` is zero or a number is not finite.
namespace octavo {

/// A camera that sees the whole box from a little above, from the direction (1, 0.6, 1.4) about
/// `up`.
[[nodiscard]] Camera default_camera(const Box& box, const dvec3& up, double aspect);

/// A camera at a place that looks in a direction.
///
/// @param forward, up   of any length
/// @param vertical_fov  radians, in (0, pi)
/// @throws Error        bad_argument where a direction is zero, `up` is parallel to the view, or
///                      the field of view is out of range
[[nodiscard]] Camera look_along(const dvec3& eye, const dvec3& forward, const dvec3& up,
                                double vertical_fov);
/// The same towards a point. @throws Error also where eye and target coincide
[[nodiscard]] Camera look_at(const dvec3& eye, const dvec3& target, const dvec3& up,
                             double vertical_fov);

/// A sun that stands at this azimuth (from the +z axis, or the nearest thing at right angles to
/// `up`, towards +x) and elevation above the horizon; radians. Its angular radius is 0.02.
[[nodiscard]] Light sun_at(double azimuth, double elevation, const dvec3& up = {0.0, 1.0, 0.0});

/// The warm sun of the default picture: 55 degrees to the camera's left, 42 degrees high.
[[nodiscard]] Light default_sun(const Camera& camera, const dvec3& up);

}  // namespace octavo
