// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/core/grid.h"
#include "octavo/mesh/scene.h"
#include "octavo/render/effects.h"
#include "octavo/render/ray_queue.h"

namespace octavo {

/// A light as one point of the grid sees it.
struct SeenLamp {
    shared::LampDisc disc;
    float strength;  // of its intensity: falls off with the distance, and beside a spot's cone
};

/// @param size  sun: angular radius, radians; lamp: radius, world units
/// @param from  grid space
[[nodiscard]] SeenLamp see_lamp(const Light& light, double size, const Grid& grid,
                                const dvec3& from);

/// Puts the rays [first, end) of a pixel towards a lamp into the queue's last group.
///
/// With many rays, a bundle of all of them first finds the times between which geometry may be
/// ([K13] section 4): rays are cut to that interval, and where there is none they are not traced.
/// What the group sees is the same to the bit.
void queue_lamp_rays(const shared::DagView& dag, const shared::GridRay& start, int face,
                     const shared::LampDisc& lamp, int first, int end, std::uint32_t seed,
                     bool beam, RayQueue& queue);

}  // namespace octavo
