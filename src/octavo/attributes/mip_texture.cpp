// SPDX-License-Identifier: MIT
// Source: Williams, "Pyramidal Parametrics", 1983.
#include "octavo/attributes/mip_texture.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "octavo/attributes/encodings.h"

namespace octavo {
namespace {

/// A column or row of texels, wherever it is asked for.
int wrapped(std::int64_t i, int size, Texture::Wrap wrap) {
    if (i >= 0 && i < size) return static_cast<int>(i);
    if (wrap == Texture::Wrap::clamp) return i < 0 ? 0 : size - 1;
    const std::int64_t period = wrap == Texture::Wrap::mirror ? 2 * std::int64_t{size} : size;
    std::int64_t in_period = i % period;
    if (in_period < 0) in_period += period;
    return static_cast<int>(in_period < size ? in_period : period - 1 - in_period);
}

/// The two texels around a place along one axis, and how much of the second there is.
struct Pair {
    int first, second;
    float part;
};
inline Pair pair_at(double coordinate, int size, Texture::Wrap wrap) {
    const double place = coordinate * size - 0.5;
    if (wrap == Texture::Wrap::repeat && (size & (size - 1)) == 0 && std::abs(place) < 1e9) {
        auto i = static_cast<int>(place);  // as nearly all textures are
        if (i > place) --i;
        return {i & (size - 1), (i + 1) & (size - 1), static_cast<float>(place - i)};
    }
    // Further out than this all digits are before the point, and so is every wrap.
    constexpr double kFar = 1e12;
    const double texel = std::clamp(place, -kFar, kFar);
    auto i = static_cast<std::int64_t>(texel);
    if (static_cast<double>(i) > texel) --i;
    return {wrapped(i, size, wrap), wrapped(i + 1, size, wrap),
            static_cast<float>(texel - static_cast<double>(i))};
}

// Four channels at once; every compiler that we build with has these.
typedef std::uint16_t Four16 __attribute__((vector_size(8)));
typedef float Four __attribute__((vector_size(16)));

inline Four channels(const std::array<std::uint16_t, 4>& texel) {
    Four16 bits;
    std::memcpy(&bits, texel.data(), sizeof bits);
    return __builtin_convertvector(bits, Four);
}

/// Sides are even.
void halve(const std::vector<std::array<std::uint16_t, 4>>& fine, int width,
           std::vector<std::array<std::uint16_t, 4>>& coarse) {
    const auto row = static_cast<std::size_t>(width), half = row / 2;
    for (std::size_t i = 0; i < coarse.size(); ++i) {
        const auto* p = &fine[i / half * 2 * row + i % half * 2];
        for (std::size_t c = 0; c < 4; ++c)
            coarse[i][c] =
                static_cast<std::uint16_t>((p[0][c] + p[1][c] + p[row][c] + p[row + 1][c] + 2) / 4);
    }
}

}  // namespace

MipTexture::MipTexture(const Texture& texture, int least_alpha)
    : wrap_u_(texture.wrap_u), wrap_v_(texture.wrap_v) {
    const Bitmap& picture = *texture.picture;
    Level first{picture.width, picture.height, {}};
    first.texels.reserve(picture.pixels.size());
    std::array<std::uint16_t, 256> linear{};
    for (std::size_t i = 0; i < linear.size(); ++i)
        linear[i] = static_cast<std::uint16_t>(
            std::lround(linear_from_srgb8(static_cast<std::uint8_t>(i)) * 65535.0f));
    for (const auto& p : picture.pixels)
        first.texels.push_back(
            p[3] >= least_alpha ? Texel{linear[p[0]], linear[p[1]], linear[p[2]], 65535} : Texel{});
    levels_.push_back(std::move(first));

    while (levels_.back().width > 1 || levels_.back().height > 1) {
        const Level& fine = levels_.back();
        Level coarse{std::max(1, fine.width / 2), std::max(1, fine.height / 2), {}};
        coarse.texels.resize(static_cast<std::size_t>(coarse.width) *
                             static_cast<std::size_t>(coarse.height));
        if (fine.width % 2 == 0 && fine.height % 2 == 0) {
            halve(fine.texels, fine.width, coarse.texels);
            levels_.push_back(std::move(coarse));
            continue;
        }
        // Where a side is odd, a coarse texel covers two fine ones and parts of a third.
        const double along_x = static_cast<double>(fine.width) / coarse.width;
        const double along_y = static_cast<double>(fine.height) / coarse.height;
        for (int y = 0; y < coarse.height; ++y)
            for (int x = 0; x < coarse.width; ++x) {
                std::array<double, 4> sum{};
                double weights = 0.0;
                const double x0 = x * along_x, x1 = x0 + along_x;
                const double y0 = y * along_y, y1 = y0 + along_y;
                for (int j = static_cast<int>(y0); j < fine.height && j < y1; ++j)
                    for (int i = static_cast<int>(x0); i < fine.width && i < x1; ++i) {
                        const double weight = (std::min(x1, i + 1.0) - std::max(x0, i + 0.0)) *
                                              (std::min(y1, j + 1.0) - std::max(y0, j + 0.0));
                        const Texel& t = fine.texels[static_cast<std::size_t>(j) *
                                                         static_cast<std::size_t>(fine.width) +
                                                     static_cast<std::size_t>(i)];
                        for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * t[c];
                        weights += weight;
                    }
                Texel& out = coarse.texels[static_cast<std::size_t>(y) *
                                               static_cast<std::size_t>(coarse.width) +
                                           static_cast<std::size_t>(x)];
                for (std::size_t c = 0; c < 4; ++c)
                    out[c] = static_cast<std::uint16_t>(sum[c] / weights + 0.5);
            }
        levels_.push_back(std::move(coarse));
    }
}

vec4 MipTexture::between_texels(const glm::dvec2& coordinate, const Level& level) const {
    const Pair u = pair_at(coordinate.x, level.width, wrap_u_);
    const Pair v = pair_at(coordinate.y, level.height, wrap_v_);
    const Texel* upper = level.texels.data() + static_cast<std::ptrdiff_t>(v.first) * level.width;
    const Texel* lower = level.texels.data() + static_cast<std::ptrdiff_t>(v.second) * level.width;
    const Four left =
        channels(upper[u.first]) * (1.0f - v.part) + channels(lower[u.first]) * v.part;
    const Four right =
        channels(upper[u.second]) * (1.0f - v.part) + channels(lower[u.second]) * v.part;
    const Four color = (left * (1.0f - u.part) + right * u.part) * (1.0f / 65535.0f);
    return {color[0], color[1], color[2], color[3]};
}

vec4 MipTexture::sample(const glm::dvec2& coordinate, int level) const {
    const int last = static_cast<int>(levels_.size()) - 1;
    return between_texels(coordinate, levels_[static_cast<unsigned>(std::clamp(level, 0, last))]);
}

vec3 MipTexture::color_around(const glm::dvec2& coordinate) const {
    for (const Level& level : levels_) {
        const vec4 color = between_texels(coordinate, level);
        if (color.a > 1e-5f) return vec3(color) / color.a;
    }
    return vec3(0.0f);
}

}  // namespace octavo
