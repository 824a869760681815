// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/light/lit_world.h"

namespace octavo {

/// Finds the light of lamps that falls on the sides of cells: one thread's.
///
/// A sun, a point or a spot first gets one ray from each place of a side. Only where these do not
/// agree, in the half-shadow, are all rays sent.
class LampGatherer {
public:
    /// @param rays   towards each lamp of a sum, rounded up to a multiple of `parts`
    /// @param parts  over how many points they are shared out
    LampGatherer(const LitWorld& world, int rays, int parts);

    /// Begins a sum. @return its number, from 0
    std::size_t begin();
    /// Adds a point to the last sum; at most `parts` of them.
    /// @param seed  of the sum's random numbers
    void add(const LitPoint& point, std::uint32_t seed);
    /// Traces what is waiting. Call it before light().
    void trace();
    [[nodiscard]] vec3 light(std::size_t sum) const { return sums_[sum]; }
    [[nodiscard]] std::uint64_t rays_traced() const { return traced_; }

private:
    /// A lamp that a sum may see.
    struct Pair {
        std::uint32_t sum, lamp;
        std::uint32_t first_point, points;  // of the sum
        std::uint32_t seed;
        int sent = 0, seen = 0;
        float light = 0.0f;
        bool few = false;
    };
    void queue(std::uint32_t pair, int rays);
    void trace_queue();

    const LitWorld& world_;
    int rays_, parts_;
    std::vector<vec3> sums_;
    std::vector<LitPoint> points_;
    std::vector<Pair> pairs_;
    std::size_t first_pair_ = 0;   // of the last sum
    std::size_t first_point_ = 0;  // of the last sum
    std::vector<shared::GridRay> queue_;
    std::vector<std::uint32_t> pair_of_;
    std::vector<float> light_of_;
    std::vector<std::uint8_t> occluded_;
    std::uint64_t traced_ = 0;
};

}  // namespace octavo
