// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include "octavo/attributes/mip_texture.h"
#include "octavo/core/vec.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// What a piece of a surface looks like, in whole numbers, so that sums of it do not depend on
/// their order.
struct SurfaceSample {
    std::array<std::uint16_t, 3> color{};     // linear, in 65535ths
    std::uint16_t opacity = 65535;            // the part of the piece that is no hole, in 65535ths
    std::array<std::uint32_t, 3> emission{};  // in 2^20ths of SurfaceSampler::greatest_emission()
};

/// Says what the surfaces of a scene look like: the material's factor, times the colours of the
/// corners, times its texture where that is decoded.
class SurfaceSampler {
public:
    /// Cost: that of filtering the textures to all their sizes. @param scene  outlives this
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

        struct Filter {
            const MipTexture* texture = nullptr;
            int level = 0;
            int samples = 1;
            float share = 1.0f;    // 1 / samples
            glm::dvec2 step{0.0};  // from one sample to the next
        };
        template <class Look>
        void for_samples(const Filter& filter, const dvec4& point, const Look& look) const;

        std::array<dvec4, 2> weights_;      // of the second and third corner: affine in the point
        std::array<dvec4, 2> coordinates_;  // in the texture, likewise
        Filter base_, glow_;
        std::array<vec4, 3> corner_colors_;
        vec3 emission_{0.0f};
        bool one_color_ = true;
        bool emits_ = false;
        bool has_holes_ = false;
    };

    /// @param triangle  of the scene
    /// @param corners   where its corners are, in the space that at() is asked in: cells
    /// @param footprint  how wide a piece is that at() stands for, in cells
    [[nodiscard]] Triangle prepare(std::size_t triangle, const std::array<dvec3, 3>& corners,
                                   double footprint) const;

private:
    static void choose_filter(Triangle::Filter& filter, const std::array<dvec4, 2>& coordinates,
                              double footprint);
    [[nodiscard]] const MipTexture* mip_texture(int texture, int least_alpha) const;

    const Scene& scene_;
    std::map<std::pair<int, int>, MipTexture> textures_;  // by index and least alpha
    float greatest_emission_ = 0.0f;
};

}  // namespace octavo
