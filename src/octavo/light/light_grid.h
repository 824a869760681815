// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octavo/core/box.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// How far a lamp reaches: beyond it a white surface that faces the lamp sends back less than
/// `least`. Infinite for a sun. World units.
[[nodiscard]] double light_reach(const Light& light, float least);

/// Says which of many lights may reach a point: clusters in world space about a centre, which is
/// the camera or the middle of what is lit ([J]: "place them in a grid in world space, with the
/// camera at the center of the grid"). Clusters are small near the centre and twice as large from
/// each shell to the next, so that a few thousand of them serve any distance.
///
/// The lists leave out nothing that light_reach() does not.
class LightGrid {
public:
    static constexpr float kLeast = 1.0f / 2048;

    LightGrid() = default;

    /// @param lit    what there is to light: the outermost shell holds it
    /// Cost           a box test for each light and each cluster that its reach touches
    LightGrid(std::span<const Light> lights, const Box& lit, const dvec3& centre,
              float least = kLeast);

    /// The numbers of the lights that may reach a point, in order; those outside the clusters get
    /// all. Cost: constant.
    [[nodiscard]] std::span<const std::uint32_t> near(const dvec3& point) const;

private:
    static constexpr int kSide = 16;  // clusters along each side of a shell

    struct Shell {
        dvec3 low{0.0};
        double cluster = 1.0;  // side of one
    };
    std::vector<Shell> shells_;          // the finest first
    std::vector<std::uint32_t> begins_;  // of each cluster of each shell, into lists_
    std::vector<std::uint32_t> lists_;
    std::vector<std::uint32_t> all_;
};

}  // namespace octavo
