// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "octavo/core/vec.h"
#include "octavo/trace/shared_text.h"

namespace octavo::shared {

struct SkyPixels {
    const vec3* at = nullptr;
};
OCTAVO_FN vec3 sky_pixel(SkyPixels pixels, int number) {
    return pixels.at[number];
}

}  // namespace octavo::shared

#include "octavo/light/sky_radiance.h"

namespace octavo {

/// A picture of the whole sphere of directions, in linear light: width twice the height, the top
/// row around `up`. Column 0 and the last meet at azimuth 180 degrees; the middle column is +z
/// where up is +y, and columns to its right go towards -x, as one sees them from inside.
struct SkyImage {
    int width = 0;
    int height = 0;
    std::vector<vec3> color;
};

/// Reads an OpenEXR file (R, G, B; half or float) or a Radiance .hdr file (RGBE, run lengths or
/// not).
///
/// @throws Error  io; bad_input where the file is damaged, has no pixel, more than 2^26 of them, or
///                one that is negative or not finite; unsupported where it is another format
[[nodiscard]] SkyImage load_sky_image(const std::filesystem::path& file);

/// A direction that light comes from, and the density with which it was chosen, per steradian.
struct SkySample {
    vec3 direction;
    float density;
};

/// The light from far away, one radiance for each direction; world space.
class Sky {
public:
    /// Black.
    Sky() = default;

    [[nodiscard]] static Sky constant(const vec3& radiance);
    /// From the horizon up to the zenith and down to the nadir, as the clear sky of render() does.
    [[nodiscard]] static Sky gradient(const vec3& zenith, const vec3& horizon, const vec3& ground,
                                      const dvec3& up);
    /// The blue sky of render()'s pictures.
    [[nodiscard]] static Sky clear(const dvec3& up);
    /// @param turn  radians about `up`
    /// @throws Error  bad_argument where the image has no pixels
    [[nodiscard]] static Sky image(SkyImage image, const dvec3& up, double turn);

    /// The same sky, brighter by this factor.
    [[nodiscard]] Sky scaled(float factor) const;

    /// @param direction  any length but zero
    [[nodiscard]] vec3 radiance(const vec3& direction) const;

    [[nodiscard]] bool black() const { return view_.kind == shared::kSkyBlack; }

    /// Whether rays should be sent by sample() too: the sky has bright places, and rays spread by
    /// the cosine alone would miss them.
    [[nodiscard]] bool uneven() const { return view_.kind == shared::kSkyImage; }

    /// A direction chosen by the brightness of what is there: of pixels of an image, after Pharr,
    /// Jakob, Humphreys, "Physically Based Rendering", 2016, section 14.2.4. Any other sky: evenly.
    /// @param square  in the unit square
    [[nodiscard]] SkySample sample(const vec2& square) const;
    /// The density with which sample() gives a direction.
    [[nodiscard]] float density(const vec3& direction) const;

    /// What a white surface with this normal sends back where nothing hides the sky: its irradiance
    /// over pi, within some percent. Ramamoorthi and Hanrahan, "An Efficient Representation for
    /// Irradiance Environment Maps", 2001.
    [[nodiscard]] vec3 diffuse(const vec3& normal) const;

    /// For the shared text; the sky, or a copy of it, must outlive the view.
    [[nodiscard]] const shared::SkyView& view() const { return view_; }
    /// The picture of an image; none for other skies.
    [[nodiscard]] std::span<const vec3> pixels() const {
        return picture_ ? std::span<const vec3>(picture_->image.color) : std::span<const vec3>();
    }

private:
    struct Picture {  // of a sphere, with sums for the choice of a pixel
        SkyImage image;
        std::vector<float> column_sums;  // height x (width + 1), each row from 0 to 1
        std::vector<float> row_sums;     // height + 1
        std::vector<float> density;      // of each pixel, per unit square
    };

    [[nodiscard]] static shared::SkyView black_view();
    [[nodiscard]] static std::shared_ptr<Picture> distribute(SkyImage image);
    void find_harmonics();

    shared::SkyView view_ = black_view();
    std::shared_ptr<const Picture> picture_;
};

}  // namespace octavo
