// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/light/lit_scene.h"
#include "octavo/trace/instances.h"

namespace octavo {

/// The cells that shine, as lamps: rays are sent into the cone that just holds a cell's cube, and
/// those that hit this cell bring its light. So whatever lies inside the cell is sampled as it is,
/// and the density of a direction is known for a ray that came upon the cell by chance.
class Emitters {
public:
    Emitters() = default;
    /// @param scene, world  the same objects
    Emitters(const LitScene& scene, const Instances& world);

    [[nodiscard]] bool empty() const { return emitters_.empty(); }
    [[nodiscard]] std::size_t size() const { return emitters_.size(); }
    /// All of them; common space.
    [[nodiscard]] const Box& bounds() const { return bounds_; }

    struct Sample {
        vec3 direction;  // unit length; common space
        float density;   // per steradian, for light that comes from this cell
        std::uint32_t object;
        std::uint64_t cell;
    };
    /// @param choice  in [0, 1): which cell, by its power
    [[nodiscard]] Sample sample(const dvec3& from, float choice, const vec2& square) const;

    /// The density of a direction from `from` that meets this cell; 0 where the cell does not
    /// shine.
    [[nodiscard]] float density(const dvec3& from, std::uint32_t object, std::uint64_t cell) const;

private:
    struct Emitter {
        std::uint32_t object;
        std::uint64_t cell;
        dvec3 centre;  // common space
        double radius;
        float part;  // of all choices
    };
    std::vector<Emitter> emitters_;  // by object, then cell
    Box bounds_;
    std::vector<double> sums_;  // of the parts up to each, 1 at the end
};

}  // namespace octavo
