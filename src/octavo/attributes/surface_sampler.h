// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "octavo/attributes/mip_texture.h"
#include "octavo/core/mapped_words.h"
#include "octavo/core/vec.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// Colour and opacity of a piece of a surface, in 65535ths. Written and copied as eight bytes: read
/// so soon after, one by one written halves would have to reach the cache first.
struct alignas(8) Tint {
    std::array<std::uint16_t, 3> color{};  // linear
    std::uint16_t opacity = 65535;         // the part of the piece that is no hole
};
static_assert(sizeof(Tint) == 8);

/// What a piece of a surface looks like, in whole numbers, so that sums of it do not depend on
/// their order.
struct SurfaceSample {
    Tint tint;
    std::array<std::uint32_t, 3> emission{};  // in 2^20ths of SurfaceSampler::greatest_emission()
};

/// Says what the surfaces of a scene look like: the material's factor, times the colours of the
/// corners, times its texture. A texture that is not decoded yet is decoded for this alone.
class SurfaceSampler {
public:
    /// @param scene    outlives this, unless a scratch folder is given
    /// @param scratch  a folder for temporary files, in which textures and what is known of each
    ///                 triangle wait to be looked at; or empty: all of it is in memory
    /// @throws Error   io
    /// Cost            that of decoding the textures and filtering them to all their sizes
    explicit SurfaceSampler(const Scene& scene, const std::filesystem::path& scratch = {});

    /// The radiance that the emission of samples is a part of; 0 where nothing emits.
    [[nodiscard]] float greatest_emission() const { return greatest_emission_; }

    /// Textures that could not be read.
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

    /// One triangle, ready to be sampled at many places.
    class Triangle {
    public:
        [[nodiscard]] bool emits() const { return emits_; }
        [[nodiscard]] SurfaceSample at(const dvec3& point) const {
            return plain_ ? plain_at(point) : any_at(point);
        }

    private:
        friend class SurfaceSampler;

        typedef double TwoDoubles __attribute__((vector_size(16)));

        struct Filter {
            const MipTexture* texture = nullptr;
            const MipTexture::Level* level = nullptr;
            std::array<dvec4, 2> coordinates;  // in the texture: affine in the point
            int samples = 1;
            float share = 1.0f;    // 1 / samples
            glm::dvec2 step{0.0};  // from one sample to the next
            // Where the level is simple: texels for MipTexture::sample_simple(), affine in the
            // point, and the step in texels.
            bool simple = false;
            std::array<TwoDoubles, 4> texels;
            TwoDoubles texel_step{};
            [[nodiscard]] detail::FourFloats sum_of_simple_samples(const dvec3& point) const;
        };
        [[nodiscard]] vec4 sum_of_samples(const Filter& filter, const dvec3& point) const;
        [[nodiscard]] SurfaceSample any_at(const dvec3& point) const;
        [[nodiscard]] SurfaceSample plain_at(const dvec3& point) const;

        std::array<dvec4, 2> weights_;  // of the second and third corner: affine in the point
        Filter base_, glow_;
        std::array<vec4, 3> corner_colors_;
        vec3 emission_{0.0f};
        bool one_color_ = true;
        bool emits_ = false;
        bool has_holes_ = false;
        bool plain_ = false;  // one colour, a simple texture or none, and nothing else: as most are
    };

    /// @param triangle  of the scene
    /// @param corners   where its corners are, in the space that at() is asked in: cells
    /// @param footprint  how wide a piece is that at() stands for, in cells
    [[nodiscard]] Triangle prepare(std::size_t triangle, const std::array<dvec3, 3>& corners,
                                   double footprint) const;

    /// Gives back what temporary files back, until it is next looked at.
    void release() const;

private:
    /// What is known of a triangle but for its place.
    struct Look {
        std::uint32_t material;
        std::array<std::array<std::uint8_t, 4>, 3> colors;
        std::array<vec2, 3> coordinates;
        std::array<vec2, 3> of_emission;  // stored only where a scene has them
    };
    static constexpr std::size_t kLookWords = 10, kLookWordsWithEmission = 16;

    /// False where the corners' coordinates are no numbers.
    static bool place(Triangle::Filter& filter, const std::array<vec2, 3>& corners,
                      const std::array<dvec4, 2>& weights);
    static void choose_filter(Triangle::Filter& filter, double footprint);
    static void simplify(Triangle::Filter& filter, const std::array<vec2, 3>& corners);
    void make_textures(const Scene& scene, const std::filesystem::path& scratch);
    void write_looks(const Scene& scene, const std::filesystem::path& scratch);
    [[nodiscard]] static Look look_of(const Scene& scene, std::size_t triangle);
    [[nodiscard]] Look look(std::size_t triangle) const;
    [[nodiscard]] const Material& material(std::uint32_t index) const;
    [[nodiscard]] const MipTexture* mip_texture(int texture, int least_alpha) const;

    const Scene* scene_;                  // where looks are not on disk
    std::shared_ptr<MappedWords> looks_;  // where they are
    std::vector<Material> materials_;
    bool has_coordinates_, has_colors_;
    std::size_t look_words_;                              // of each triangle, on disk
    std::map<std::pair<int, int>, MipTexture> textures_;  // by index and least alpha
    std::vector<std::string> warnings_;
    float greatest_emission_ = 0.0f;
};

inline detail::FourFloats SurfaceSampler::Triangle::Filter::sum_of_simple_samples(
    const dvec3& point) const {
    TwoDoubles at = (texels[0] * point.x + texels[1] * point.y) + (texels[2] * point.z + texels[3]);
    if (samples > 1) at += -0.5 * (samples - 1) * texel_step;
    const auto within = [](double texel) {
        return std::min(std::max(0.0, texel), 2.0 * MipTexture::Level::kPeriods);
    };
    at = TwoDoubles{within(at[0]), within(at[1])};
    detail::FourFloats sum = level->sample_simple({at[0], at[1]});
    for (int i = 1; i < samples; ++i) {
        at += texel_step;
        sum += level->sample_simple({at[0], at[1]});
    }
    return sum * (1.0f / 65535.0f);
}

inline SurfaceSample SurfaceSampler::Triangle::plain_at(const dvec3& point) const {
    using detail::FourFloats;
    const vec4& c = corner_colors_[0];
    FourFloats color = {c.r, c.g, c.b, 0.0f};
    if (base_.texture) color *= base_.sum_of_simple_samples(point) * base_.share;
    const FourFloats none{}, one = none + 1.0f;
    color = color > none ? color : none;
    color = color < one ? color : one;
    SurfaceSample sample;
    const detail::EightWords tint = detail::low_words(
        __builtin_convertvector(color * 65535.0f + 0.5f, detail::FourInts), 65535);
    std::memcpy(static_cast<void*>(&sample.tint), &tint, sizeof sample.tint);
    return sample;
}

}  // namespace octavo
