// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/light/point_text.h"

namespace octavo {

/// A unit normal of the surface that the voxels stand for.
///
/// Adds up the faces, as vectors, that the cells around the hit turn to the empty space in front of
/// it. For a slanted plane that is its normal, however the steps lie; and because only the space
/// that is connected to the hit's face counts, the back of a thin wall does not cancel its front.
/// Nearer cells count more. Cells are as large as the one that was hit.
///
/// Cost: about that of two rays. The bits are those of shared::smooth_normal_32().
[[nodiscard]] vec3 smooth_normal(const shared::DagView& dag, const shared::GridRay& ray,
                                 const shared::GridHit& hit) noexcept;

}  // namespace octavo
