// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "octavo/core/grid.h"
#include "octavo/light/point_text.h"
#include "octavo/mesh/scene.h"
#include "octavo/trace/ray_queue.h"

namespace octavo {

/// A light placed in a grid, made ready to be seen from many points.
///
/// Lamps with an area are often voxels as well, and these must not shade the lamp: its rays end
/// above the surface, on the point's side, where voxels of a flat or convex lamp do not reach.
class Lamp {
public:
    Lamp(const Light& light, const Grid& grid);

    [[nodiscard]] const Light& light() const { return light_; }

    /// As the shared text wants it. Its triangles are those of this lamp, which must outlive it.
    [[nodiscard]] shared::PlacedLamp placed() const {
        shared::PlacedLamp placed = placed_;
        placed.triangles.at = const_cast<shared::LampTriangle*>(triangles_.data());
        return placed;
    }
    [[nodiscard]] std::span<const shared::LampTriangle> triangles() const { return triangles_; }

private:
    void place_triangles(const Grid& grid);

    Light light_;
    shared::PlacedLamp placed_{};
    std::vector<shared::LampTriangle> triangles_;
};

/// A lamp as one point of a surface sees it: see lamp_light.h.
class SeenLamp {
public:
    /// @param start   the point; see sky_ray() for it and `face`
    /// @param normal  unit length
    /// @param hard    rays go to the lamp's middle alone; one of triangles has none
    SeenLamp(const Lamp& lamp, const shared::GridRay& start, int face, const vec3& normal,
             bool hard)
        : lamp_(lamp.placed()), seen_(see_lamp(lamp_, start, face, normal, hard ? 1 : 0)) {}

    [[nodiscard]] bool dark() const { return seen_.dark != 0; }
    [[nodiscard]] shared::LampSample ray(int i, std::uint32_t seed) const {
        return lamp_sample(lamp_, seen_, i, seed);
    }
    [[nodiscard]] shared::Bundle bundle() const { return seen_lamp_bundle(lamp_, seen_); }

private:
    shared::PlacedLamp lamp_;
    shared::SeenPlacedLamp seen_;
};

/// Puts the rays [first, end) of a pixel towards a lamp into the queue's last group, which adds up
/// the light of those that see it; rays are not cut to the lamp's interval, which GPUs do
/// (docs/adr/0032-partitions.md). What the group sees is that of shared::lamp_light(), to the bit
/// but for the order of the sum.
///
/// @return  the light of all rays, seen or not
float queue_lamp_rays(const SeenLamp& lamp, int first, int end, std::uint32_t seed,
                      RayQueue& queue);

}  // namespace octavo
