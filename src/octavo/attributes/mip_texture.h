// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "octavo/attributes/four_channels.h"
#include "octavo/core/vec.h"
#include "octavo/mesh/scene.h"

namespace octavo {

namespace detail {

/// The two texels around a place along one axis, and how much of the second there is.
struct TexelPair {
    int first, second;
    float part;
};

}  // namespace detail

/// A picture in linear light at its own size and at halves of it, each texel the mean of those that
/// it covers. What is no part of the surface does not count: colours are multiplied by opacity,
/// which is 0 or 1 at full size.
///
/// Memory: the picture, 4 bytes for each pixel, and 8 thirds for what is smaller; 8 more once a
/// place is looked at in full size, which few scenes need. With a scratch folder, all sizes of a
/// picture that is not small are on disk, and the picture is not kept.
class MipTexture {
public:
    struct Wraps {
        Texture::Wrap u = Texture::Wrap::repeat;
        Texture::Wrap v = Texture::Wrap::repeat;
    };

    /// @param least_alpha  alpha from which a pixel is part of the surface, 0 to 256; 0: all are
    /// @param scratch      a folder for a temporary file; or empty
    MipTexture(std::shared_ptr<const Bitmap> picture, Wraps wraps, int least_alpha,
               const std::filesystem::path& scratch = {});

    [[nodiscard]] int width() const { return levels_[0].width; }
    [[nodiscard]] int height() const { return levels_[0].height; }

    /// The picture at one of its sizes.
    class Level {
    public:
        /// Linear light times opacity, and opacity; 0 to 1. Between texels it is linear.
        /// @param coordinate  (0, 0) is the picture's upper left corner, (1, 1) the lower right one
        [[nodiscard]] vec4 sample(const glm::dvec2& coordinate) const;

        /// Does it repeat both ways, by powers of two?
        [[nodiscard]] bool is_simple() const {
            return wraps.u == Texture::Wrap::repeat && wraps.v == Texture::Wrap::repeat &&
                   (width & (width - 1)) == 0 && (height & (height - 1)) == 0;
        }
        [[nodiscard]] glm::dvec2 size() const { return {width, height}; }

        /// Of one that is simple, 65535 times the same.
        /// @param texels  from the middle of the first texel, and kPeriods further on both ways;
        ///                not negative
        [[nodiscard]] detail::FourFloats sample_simple(const glm::dvec2& texels) const;
        static constexpr double kPeriods = 1073741824.0;  // of any size

    private:
        friend class MipTexture;
        [[nodiscard]] detail::FourFloats between(const detail::TexelPair& u,
                                                 const detail::TexelPair& v) const;

        const std::uint32_t* texels = nullptr;  // two words each
        int width = 0, height = 0;
        Wraps wraps;
    };
    /// @param level  log2 of the texels of the picture that a texel here is wide; 0 or more
    [[nodiscard]] const Level& level(int level) const {
        const std::size_t i = std::min(static_cast<std::size_t>(level), levels_.size() - 1);
        return i == 0 && finest_ ? finest() : levels_[i];
    }

    /// The colour of the surface at the finest level that has any near this place; black where it
    /// is nothing but hole.
    [[nodiscard]] vec3 color_around(const glm::dvec2& coordinate) const;

    /// Gives back what a temporary file backs, until it is next looked at.
    void release() const;

private:
    /// The level of full size, where it is made when it is first asked for.
    struct Finest {
        std::shared_ptr<const Bitmap> picture;
        int least_alpha = 0;
        std::once_flag made;
        std::unique_ptr<std::uint32_t[]> texels;
        Level level;
    };
    [[nodiscard]] const Level& finest() const;

    std::vector<Level> levels_;
    std::shared_ptr<Finest> finest_;
    std::span<const std::uint32_t> words_;
    std::shared_ptr<const void> owner_;
    bool on_disk_ = false;
};

namespace detail {

/// A column or row of texels, wherever it is asked for.
[[nodiscard]] int wrapped_texel(std::int64_t i, int size, Texture::Wrap wrap);

inline TexelPair texels_around(double coordinate, int size, Texture::Wrap wrap) {
    const double place = coordinate * size - 0.5;
    // Further out than this all digits are before the point, and so is every wrap.
    constexpr double kFar = 1e12;
    const double texel = std::clamp(place, -kFar, kFar);
    auto i = static_cast<std::int64_t>(texel);
    if (static_cast<double>(i) > texel) --i;
    return {wrapped_texel(i, size, wrap), wrapped_texel(i + 1, size, wrap),
            static_cast<float>(texel - static_cast<double>(i))};
}

}  // namespace detail

inline vec4 MipTexture::Level::sample(const glm::dvec2& coordinate) const {
    using namespace detail;
    const TexelPair u = texels_around(coordinate.x, width, wraps.u);
    const TexelPair v = texels_around(coordinate.y, height, wraps.v);
    const FourFloats sum = between(u, v) * (1.0f / 65535.0f);
    return {sum[0], sum[1], sum[2], sum[3]};
}

inline detail::FourFloats MipTexture::Level::sample_simple(const glm::dvec2& texels_on) const {
    // Nothing is negative, so cutting off the digits behind the point is rounding down.
    const auto pair = [](double place, int size) -> detail::TexelPair {
        const auto i = static_cast<std::int64_t>(place);
        const auto first = static_cast<int>(i);
        return {first & (size - 1), (first + 1) & (size - 1),
                static_cast<float>(place - static_cast<double>(i))};
    };
    return between(pair(texels_on.x, width), pair(texels_on.y, height));
}

inline detail::FourFloats MipTexture::Level::between(const detail::TexelPair& u,
                                                     const detail::TexelPair& v) const {
    using namespace detail;
    const std::uint32_t* upper = texels + 2 * static_cast<std::ptrdiff_t>(v.first) * width;
    const std::uint32_t* lower = texels + 2 * static_cast<std::ptrdiff_t>(v.second) * width;
    const FourFloats left = texel_channels(upper + 2 * std::ptrdiff_t{u.first}) * (1.0f - v.part) +
                            texel_channels(lower + 2 * std::ptrdiff_t{u.first}) * v.part;
    const FourFloats right =
        texel_channels(upper + 2 * std::ptrdiff_t{u.second}) * (1.0f - v.part) +
        texel_channels(lower + 2 * std::ptrdiff_t{u.second}) * v.part;
    return left * (1.0f - u.part) + right * u.part;
}

}  // namespace octavo
