// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octavo/light/kept_ends.h"
#include "octavo/light/lit_world.h"

namespace octavo {

/// Where the light that is gathered comes from.
enum class LightFrom {
    lamps = 1,    // straight from lamps
    sources = 2,  // straight from the sky and from cells that shine
    cells = 4,    // sent back by cells, as it is stored for them
};
[[nodiscard]] constexpr LightFrom operator|(LightFrom a, LightFrom b) {
    return static_cast<LightFrom>(static_cast<int>(a) | static_cast<int>(b));
}
[[nodiscard]] constexpr bool has(LightFrom set, LightFrom one) {
    return (static_cast<int>(set) & static_cast<int>(one)) != 0;
}

/// How many rays ask what light falls on a point.
struct GatherRays {
    int lamp = 16;      // towards each lamp in reach that has a size
    int around = 32;    // over the hemisphere, by the cosine
    int source = 16;    // towards an uneven sky, and as many towards cells that shine
    bool hard = false;  // rays to lamps go to their middle
};

/// Finds the light that falls on points, many rays at a time: one thread's.
///
/// Rays over the hemisphere and rays towards bright sky and shining cells may find the same light;
/// each counts by how likely it was to (the balance heuristic of Veach and Guibas, "Optimally
/// Combining Sampling Techniques for Monte Carlo Rendering", 1995).
class Gatherer {
public:
    /// @param parts  over how many points the rays of each sum are shared out; counts are rounded
    ///               up to multiples of it
    Gatherer(const LitWorld& world, LightFrom from, const GatherRays& rays, int parts);

    /// Begins a sum. @return its number, from 0
    std::size_t begin();

    /// Adds rays of one point to the last sum.
    ///
    /// @param part  0 to parts - 1, each once
    /// @param seed  of the sum's random numbers
    /// @param kept  what is known of its rays over the hemisphere, for start() has been called;
    ///              those whose end it knows are not traced. The sky is even. Or none
    void add(const LitPoint& point, int part, std::uint32_t seed, const KeptEnds* kept = nullptr);

    /// Traces what is waiting. Call it before light().
    void trace();

    /// What a white surface at the points of the sum sends back: irradiance over pi.
    [[nodiscard]] vec3 light(std::size_t sum) const { return sums_[sum]; }

    /// Keeps where the last ray over the hemisphere of each sum ended, for hit().
    void keep_hits() { keeps_hits_ = true; }
    [[nodiscard]] const InstanceHit& hit(std::size_t sum) const { return kept_[sum]; }

    /// What a ray met: the side of a cell, and where the ray came from, in the object's space.
    struct MetSide {
        CellSide side;
        vec3 towards{0.0f};
        bool traced = false, met = false;
    };
    /// Keeps what each ray over the hemisphere met, for sides(): no cell where it met none.
    void keep_sides() { keeps_sides_ = true; }
    [[nodiscard]] std::span<const MetSide> sides(std::size_t sum) const {
        const auto count = static_cast<std::size_t>(rays_.around);
        return std::span(kept_sides_).subspan(sum * count, count);
    }

    [[nodiscard]] std::uint64_t rays_traced() const { return traced_; }

    void clear() {
        sums_.clear();
        kept_.clear();
        kept_sides_.clear();
    }

private:
    /// Brings its light unless it meets something.
    struct RayToLight {
        vec3 light;
        std::uint32_t sum;
    };
    /// A ray over the hemisphere, or towards a cell that shines.
    struct LookingRay {
        static constexpr std::uint32_t kAround = 0xffffffffu;

        vec3 light;  // a factor of what it finds; where it is open, what it brings
        std::uint32_t sum = 0;
        bool open = false;         // around: known to meet nothing, and not traced
        std::uint32_t number = 0;  // around: of those over the hemisphere
        float density = 0.0f;      // around: of its direction, by the cosine
        std::uint32_t emitter_object = kAround;
        std::uint64_t emitter_cell = 0;

        [[nodiscard]] bool around() const { return emitter_object == kAround; }
    };
    static constexpr std::size_t kMostRays = 8192;

    [[nodiscard]] ivec2 share(int count, int part) const {
        return {count / parts_ * part, count / parts_ * (part + 1)};
    }
    [[nodiscard]] std::uint32_t last_sum() const {
        return static_cast<std::uint32_t>(sums_.size() - 1);
    }
    void add_lamps(const LitPoint& point, int part, std::uint32_t seed);
    void add_around(const LitPoint& point, int part, std::uint32_t seed, const KeptEnds* kept);
    void add_sky(const LitPoint& point, int part, std::uint32_t seed);
    void add_emitters(const LitPoint& point, int part, std::uint32_t seed);
    [[nodiscard]] float source_weight(float cosine, float density) const;
    [[nodiscard]] float around_weight(float density, float source_density) const;
    [[nodiscard]] vec3 found(const LookingRay& looking, const shared::GridRay& ray,
                             const InstanceHit& hit);

    const LitWorld& world_;
    LightFrom from_;
    GatherRays rays_;
    int parts_;
    bool keeps_hits_ = false;
    bool keeps_sides_ = false;
    std::vector<InstanceHit> kept_;
    std::vector<MetSide> kept_sides_;  // as many for each sum as rays go around
    std::vector<vec3> sums_;
    std::vector<RayToLight> to_light_;
    std::vector<LookingRay> looking_;
    std::vector<shared::GridRay> any_rays_;      // of to_light_
    std::vector<shared::GridRay> closest_rays_;  // of looking_, but for those that are open
    std::vector<std::uint8_t> occluded_;
    std::vector<InstanceHit> hits_;
    std::uint64_t traced_ = 0;
};

}  // namespace octavo
