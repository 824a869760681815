// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "octavo/light/emitters.h"
#include "octavo/light/lamp.h"
#include "octavo/light/light_grid.h"
#include "octavo/light/lit_scene.h"
#include "octavo/light/normal_cache.h"
#include "octavo/trace/instances.h"

namespace octavo {

/// A point that light falls on: where its rays start, in common space, and its normal.
struct LitPoint {
    shared::GridRay start;
    int face = shared::kFaceNone;  // of a cell that rays must not go into
    vec3 normal{0.0f};             // unit length

    [[nodiscard]] dvec3 position() const { return origin_of(start); }
};

/// One side of a cell, as rays find it.
struct CellSide {
    static constexpr std::uint64_t kNoCell = ~std::uint64_t{0};

    std::uint32_t object = 0;
    std::uint64_t cell = kNoCell;  // of the object's attributes
    int direction = 0;             // from where it is seen, 2 * axis + (1 for +axis)
};

/// The smoothed normals that one thread has met, for each object.
using NormalCaches = std::map<std::uint32_t, NormalCache>;

/// The unit vector of a direction.
[[nodiscard]] inline vec3 direction_vector(int direction) {
    vec3 v(0.0f);
    v[direction / 2] = (direction & 1) == 1 ? 1.0f : -1.0f;
    return v;
}

/// A scene made ready for light: rays through all objects, lamps by place, and the cells that
/// shine.
class LitWorld {
public:
    /// @param scene   outlives this, and so do the objects' light arrays, which may change
    /// @param centre  of the clusters of lights, world space: the camera; none: the scene's middle
    /// @param walk    of all rays
    /// @throws Error  bad_argument where the scene has no object
    explicit LitWorld(const LitScene& scene, const std::optional<dvec3>& centre = {},
                      WideWalk walk = WideWalk::by_size);

    [[nodiscard]] const LitScene& scene() const { return scene_; }
    [[nodiscard]] const Instances& instances() const { return instances_; }
    [[nodiscard]] const Emitters& emitters() const { return emitters_; }
    [[nodiscard]] std::span<const Lamp> lamps() const { return lamps_; }
    /// The lamps that may reach a point of common space.
    [[nodiscard]] std::span<const std::uint32_t> lamps_near(const dvec3& point) const {
        return grid_.near(instances_.grid().to_world(point));
    }

    /// The point where rays start that ask what light falls on a hit.
    ///
    /// With a smoothed normal it is lifted off the face by up to 1.5 voxels, since the steps of a
    /// slanted plane must not shade it: to a place that a straight line reaches from before the
    /// hit, so that no wall, however thin, lies between. Else it stays on the face exactly.
    [[nodiscard]] LitPoint point(const InstanceHit& hit, bool smooth, NormalCaches& normals) const;
    /// The same with a normal that is known. @param normal  the object's space
    [[nodiscard]] LitPoint point(std::uint32_t object, const shared::GridRay& on_face, int face,
                                 const vec3& normal) const;

    /// The side of the cell that was hit.
    [[nodiscard]] CellSide side(const InstanceHit& hit) const;
    /// What part of the light a side sends back; clay where the object has no colour.
    [[nodiscard]] vec3 albedo(const CellSide& side) const;
    [[nodiscard]] vec3 emission(const CellSide& side) const;
    /// The light stored for the side of a hit, see shared::side_light().
    [[nodiscard]] vec3 stored_light(const InstanceHit& hit, const CellSide& side) const;

    /// World space; any length.
    [[nodiscard]] vec3 sky(const vec3& direction) const { return scene_.sky.radiance(direction); }

private:
    const LitScene& scene_;
    Instances instances_;
    std::vector<Lamp> lamps_;
    LightGrid grid_;
    Emitters emitters_;
};

}  // namespace octavo
