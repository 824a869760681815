// SPDX-License-Identifier: MIT
// Source: Williams, "Pyramidal Parametrics", 1983.
#include "octavo/attributes/mip_texture.h"

#include <algorithm>

#include "octavo/attributes/encodings.h"
#include "octavo/core/mapped_words.h"

namespace octavo {
namespace {

using Texel = std::array<std::uint16_t, 4>;
static_assert(sizeof(Texel) == 2 * sizeof(std::uint32_t));

constexpr std::size_t kSmallWords = 16384;

Texel load(const std::uint32_t* texels, std::size_t i) {
    Texel texel;
    std::memcpy(&texel, texels + 2 * i, sizeof texel);
    return texel;
}

void store(std::uint32_t* texels, std::size_t i, const Texel& texel) {
    std::memcpy(texels + 2 * i, &texel, sizeof texel);
}

struct Size {
    int width, height;
    [[nodiscard]] std::size_t texels() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
};

/// Of each byte of sRGB.
const std::array<std::uint16_t, 256>& linear_table() {
    static const std::array<std::uint16_t, 256> table = [] {
        std::array<std::uint16_t, 256> linear{};
        for (std::size_t i = 0; i < linear.size(); ++i)
            linear[i] = static_cast<std::uint16_t>(
                std::lround(linear_from_srgb8(static_cast<std::uint8_t>(i)) * 65535.0f));
        return linear;
    }();
    return table;
}

/// The texels of a picture at full size.
class PictureTexels {
public:
    PictureTexels(const Bitmap& picture, int least_alpha)
        : pixels_(picture.pixels.data()), least_alpha_(least_alpha), linear_(linear_table()) {}

    [[nodiscard]] Texel operator()(std::size_t i) const {
        const auto& p = pixels_[i];
        if (p[3] < least_alpha_) return {};
        return {linear_[p[0]], linear_[p[1]], linear_[p[2]], 65535};
    }

private:
    const std::array<std::uint8_t, 4>* pixels_;
    int least_alpha_;
    const std::array<std::uint16_t, 256>& linear_;
};

/// Texels that are stored.
struct StoredTexels {
    const std::uint32_t* texels;

    [[nodiscard]] Texel operator()(std::size_t i) const { return load(texels, i); }
};

/// Sides of the fine one are even.
template <class Fine>
void halve(const Fine& fine, const Size& to, std::uint32_t* coarse) {
    const auto width = static_cast<std::size_t>(to.width), row = 2 * width;
    for (std::size_t y = 0; y < static_cast<std::size_t>(to.height); ++y)
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t first = 2 * y * row + 2 * x;
            const Texel a = fine(first), b = fine(first + 1);
            const Texel c = fine(first + row), d = fine(first + row + 1);
            Texel mean;
            for (std::size_t k = 0; k < 4; ++k)
                mean[k] = static_cast<std::uint16_t>((a[k] + b[k] + c[k] + d[k] + 2) / 4);
            store(coarse, y * width + x, mean);
        }
}

/// Where a side is odd, a coarse texel covers two fine ones and parts of a third.
void reduce(const std::uint32_t* fine, const Size& from, std::uint32_t* coarse, const Size& to) {
    const double along_x = static_cast<double>(from.width) / to.width;
    const double along_y = static_cast<double>(from.height) / to.height;
    std::size_t next = 0;
    for (int y = 0; y < to.height; ++y)
        for (int x = 0; x < to.width; ++x) {
            std::array<double, 4> sum{};
            double weights = 0.0;
            const double x0 = x * along_x, x1 = x0 + along_x;
            const double y0 = y * along_y, y1 = y0 + along_y;
            for (int j = static_cast<int>(y0); j < from.height && j < y1; ++j)
                for (int i = static_cast<int>(x0); i < from.width && i < x1; ++i) {
                    const double weight = (std::min(x1, i + 1.0) - std::max(x0, i + 0.0)) *
                                          (std::min(y1, j + 1.0) - std::max(y0, j + 0.0));
                    const Texel t = load(
                        fine, static_cast<std::size_t>(j) * static_cast<std::size_t>(from.width) +
                                  static_cast<std::size_t>(i));
                    for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * t[c];
                    weights += weight;
                }
            Texel mean;
            for (std::size_t c = 0; c < 4; ++c)
                mean[c] = static_cast<std::uint16_t>(sum[c] / weights + 0.5);
            store(coarse, next++, mean);
        }
}

}  // namespace

int detail::wrapped_texel(std::int64_t i, int size, Texture::Wrap wrap) {
    if (i >= 0 && i < size) return static_cast<int>(i);
    if (wrap == Texture::Wrap::clamp) return i < 0 ? 0 : size - 1;
    const std::int64_t period = wrap == Texture::Wrap::mirror ? 2 * std::int64_t{size} : size;
    std::int64_t in_period = i % period;
    if (in_period < 0) in_period += period;
    return static_cast<int>(in_period < size ? in_period : period - 1 - in_period);
}

MipTexture::MipTexture(std::shared_ptr<const Bitmap> picture, Wraps wraps, int least_alpha,
                       const std::filesystem::path& scratch) {
    std::vector<Size> sizes = {{picture->width, picture->height}};
    while (sizes.back().width > 1 || sizes.back().height > 1)
        sizes.push_back(
            {std::max(1, sizes.back().width / 2), std::max(1, sizes.back().height / 2)});
    const auto even = [](const Size& size) { return size.width % 2 == 0 && size.height % 2 == 0; };
    const bool later = scratch.empty() && even(sizes[0]);
    std::size_t count = 0;
    for (std::size_t l = later ? 1 : 0; l < sizes.size(); ++l) count += 2 * sizes[l].texels();

    auto words = std::make_shared_for_overwrite<std::uint32_t[]>(count);
    std::uint32_t* texels = words.get();
    const PictureTexels finest(*picture, least_alpha);
    if (!later) {
        for (std::size_t i = 0; i < sizes[0].texels(); ++i) store(texels, i, finest(i));
        texels += 2 * sizes[0].texels();
    }
    for (std::size_t l = 1; l < sizes.size(); ++l) {
        const StoredTexels fine{texels - 2 * sizes[l - 1].texels()};
        if (l == 1 && later) {
            halve(finest, sizes[l], texels);
        } else if (even(sizes[l - 1])) {
            halve(fine, sizes[l], texels);
        } else {
            reduce(fine.texels, sizes[l - 1], texels, sizes[l]);
        }
        texels += 2 * sizes[l].texels();
    }

    words_ = {words.get(), count};
    if (!scratch.empty() && count > kSmallWords) {
        SpillFile file(scratch / "texture", SpillFile::Kind::temporary);
        file.write(0, words.get(), count * sizeof(std::uint32_t));
        auto mapped = std::make_shared<const MappedWords>(file, count);
        words_ = mapped->words();
        owner_ = std::move(mapped);
        on_disk_ = true;
    } else {
        owner_ = std::move(words);
    }
    const std::uint32_t* at = words_.data();
    for (const Size& size : sizes) {
        Level& level = levels_.emplace_back();
        level.width = size.width;
        level.height = size.height;
        level.wraps = wraps;
        if (later && levels_.size() == 1) continue;
        level.texels = at;
        at += 2 * size.texels();
    }
    if (later) {
        finest_ = std::make_shared<Finest>();
        finest_->picture = std::move(picture);
        finest_->least_alpha = least_alpha;
        finest_->level = levels_[0];
    }
}

const MipTexture::Level& MipTexture::finest() const {
    std::call_once(finest_->made, [this] {
        const PictureTexels texels(*finest_->picture, finest_->least_alpha);
        const std::size_t count = finest_->picture->pixels.size();
        finest_->texels = std::make_unique_for_overwrite<std::uint32_t[]>(2 * count);
        for (std::size_t i = 0; i < count; ++i) store(finest_->texels.get(), i, texels(i));
        finest_->level.texels = finest_->texels.get();
    });
    return finest_->level;
}

vec3 MipTexture::color_around(const glm::dvec2& coordinate) const {
    for (int i = 0; i < static_cast<int>(levels_.size()); ++i) {
        const vec4 color = level(i).sample(coordinate);
        if (color.a > 1e-5f) return vec3(color) / color.a;
    }
    return vec3(0.0f);
}

void MipTexture::release() const {
    if (on_disk_) release_pages(words_);
}

}  // namespace octavo
