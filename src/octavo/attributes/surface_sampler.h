// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "octavo/core/vec.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// What a piece of a surface looks like, in whole numbers, so that sums of it do not depend on
/// their order.
struct SurfaceSample {
    std::array<std::uint32_t, 3> color{};     // linear, in 65535ths
    std::uint32_t opacity = 65535;            // the part of the piece that is no hole, in 65535ths
    std::array<std::uint32_t, 3> emission{};  // in 2^20ths of SurfaceSampler::greatest_emission()
};

/// Says what the surfaces of a scene look like.
class SurfaceSampler {
public:
    /// @param scene  outlives this
    explicit SurfaceSampler(const Scene& scene);

    /// The radiance that the emission of samples is a part of; 0 where nothing emits.
    [[nodiscard]] float greatest_emission() const { return greatest_emission_; }

    /// One triangle, ready to be sampled at many places.
    class Triangle {
    public:
        [[nodiscard]] bool emits() const { return emits_; }
        [[nodiscard]] SurfaceSample at(const dvec3& point) const;

    private:
        friend class SurfaceSampler;

        std::array<dvec4, 2> weights_;  // of the second and third corner: affine in the point
        std::array<vec4, 3> corner_colors_;
        vec3 emission_{0.0f};
        bool one_color_ = true;
        bool emits_ = false;
    };

    /// @param triangle  of the scene
    /// @param corners   where its corners are, in the space that at() is asked in
    [[nodiscard]] Triangle prepare(std::size_t triangle, const std::array<dvec3, 3>& corners) const;

private:
    const Scene& scene_;
    float greatest_emission_ = 0.0f;
};

}  // namespace octavo
