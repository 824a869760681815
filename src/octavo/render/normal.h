// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/render/effects.h"

namespace octavo {

/// The unit normal of the face that was hit; against the ray where it starts inside a cell.
[[nodiscard]] vec3 face_normal(const shared::GridRay& ray, const shared::GridHit& hit) noexcept;

/// The hit, on a face of its cell that open space lies before.
///
/// A ray that first stops at larger cells comes through the empty half of one, which it was still
/// too near to stop at, into the side of the next. That side is inside the surface as the larger
/// cells draw it, and would show as a dark line; the hit goes to the face that looks most towards
/// the ray.
[[nodiscard]] shared::GridHit move_to_open_face(const shared::DagView& dag,
                                                const shared::GridRay& ray,
                                                shared::GridHit hit) noexcept;

/// A unit normal of the surface that the voxels stand for.
///
/// Adds up the faces, as vectors, that the cells around the hit turn to the empty space in front of
/// it. For a slanted plane that is its normal, however the steps lie; and because only the space
/// that is connected to the hit's face counts, the back of a thin wall does not cancel its front.
/// Nearer cells count more. Cells are as large as the one that was hit.
///
/// Cost: about that of two rays.
[[nodiscard]] vec3 smooth_normal(const shared::DagView& dag, const shared::GridRay& ray,
                                 const shared::GridHit& hit) noexcept;

}  // namespace octavo
