// SPDX-License-Identifier: MIT
#include "octavo/light/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "octavo/core/error.h"

namespace octavo {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// The clear sky of render()'s pictures.
const vec3 kZenith(0.30f, 0.47f, 0.78f);
const vec3 kHorizon(0.80f, 0.86f, 0.93f);
const vec3 kGround(0.42f, 0.39f, 0.35f);

float luminance(const vec3& color) {
    return glm::dot(color, vec3(0.2126f, 0.7152f, 0.0722f));
}

/// Real spherical harmonics up to degree 2.
std::array<float, 9> harmonics(const vec3& n) {
    return {0.282095f,
            0.488603f * n.y,
            0.488603f * n.z,
            0.488603f * n.x,
            1.092548f * n.x * n.y,
            1.092548f * n.y * n.z,
            0.315392f * (3.0f * n.z * n.z - 1.0f),
            1.092548f * n.x * n.z,
            0.546274f * (n.x * n.x - n.y * n.y)};
}

/// Index of the last sum that is not above x, of sums that go up from 0 to 1.
int find_interval(const float* sums, int count, float x) {
    const float* above = std::upper_bound(sums + 1, sums + count, x);
    return static_cast<int>(above - sums) - 1;
}

}  // namespace

shared::SkyView Sky::black_view() {
    shared::SkyView view{};
    view.kind = shared::kSkyBlack;
    view.factor = 1.0f;
    view.up = vec3(0.0f, 1.0f, 0.0f);
    view.right = vec3(-1.0f, 0.0f, 0.0f);
    view.front = vec3(0.0f, 0.0f, 1.0f);
    return view;
}

Sky Sky::constant(const vec3& radiance) {
    Sky sky;
    sky.view_.kind = radiance == vec3(0.0f) ? shared::kSkyBlack : shared::kSkyConstant;
    sky.view_.zenith = sky.view_.horizon = sky.view_.ground = radiance;
    sky.find_harmonics();
    return sky;
}

Sky Sky::gradient(const vec3& zenith, const vec3& horizon, const vec3& ground, const dvec3& up) {
    Sky sky;
    sky.view_.kind = shared::kSkyGradient;
    sky.view_.zenith = zenith;
    sky.view_.horizon = horizon;
    sky.view_.ground = ground;
    sky.view_.up = vec3(glm::normalize(up));
    sky.find_harmonics();
    return sky;
}

Sky Sky::clear(const dvec3& up) {
    return gradient(kZenith, kHorizon, kGround, up);
}

/// How a picture's light is distributed. Every pixel keeps a thousandth of the mean, so that no
/// direction is left out.
std::shared_ptr<Sky::Picture> Sky::distribute(SkyImage image) {
    auto picture = std::make_shared<Picture>();
    const auto width = static_cast<std::size_t>(image.width);
    const auto height = static_cast<std::size_t>(image.height);
    picture->column_sums.resize((width + 1) * height);
    picture->row_sums.resize(height + 1);
    picture->density.resize(image.color.size());
    double mean = 0.0;
    for (const vec3& c : image.color) mean += static_cast<double>(luminance(c));
    mean /= static_cast<double>(image.color.size());
    const double least = mean > 0.0 ? 1e-3 * mean : 1.0;
    const auto light_of = [&](std::size_t pixel) {
        return std::max(static_cast<double>(luminance(image.color[pixel])), least);
    };
    std::vector<double> rows(height);
    double total = 0.0;
    for (std::size_t y = 0; y < height; ++y) {
        const double sine =
            std::sin(std::numbers::pi * (static_cast<double>(y) + 0.5) / image.height);
        const std::size_t first = y * width;
        double sum = 0.0;
        for (std::size_t x = 0; x < width; ++x) sum += light_of(first + x);
        double so_far = 0.0;
        float* sums = picture->column_sums.data() + y * (width + 1);
        for (std::size_t x = 0; x < width; ++x) {
            const double light = light_of(first + x);
            picture->density[first + x] = static_cast<float>(light * sine);
            so_far += light;
            sums[x + 1] = static_cast<float>(so_far / sum);
        }
        sums[width] = 1.0f;
        rows[y] = sum * sine;
        total += sum * sine;
    }
    double so_far = 0.0;
    for (std::size_t y = 0; y < height; ++y) {
        so_far += rows[y];
        picture->row_sums[y + 1] = static_cast<float>(so_far / total);
    }
    picture->row_sums.back() = 1.0f;
    const auto pixels = static_cast<float>(image.color.size());
    for (float& d : picture->density) d *= pixels / static_cast<float>(total);
    picture->image = std::move(image);
    return picture;
}

Sky Sky::image(SkyImage image, const dvec3& up, double turn) {
    if (image.width < 1 || image.height < 1 ||
        image.color.size() !=
            static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
        throw Error(Errc::bad_argument, "a sky's image has no pixels");
    Sky sky;
    sky.view_.kind = shared::kSkyImage;
    sky.view_.up = vec3(glm::normalize(up));
    // The front is the nearest thing to +z at right angles to up.
    dvec3 front(0.0, 0.0, 1.0);
    const dvec3 u(sky.view_.up);
    if (std::abs(u.z) > 0.99) front = {1.0, 0.0, 0.0};
    front = glm::normalize(front - glm::dot(front, u) * u);
    const dvec3 right = glm::cross(front, u);
    sky.view_.front = vec3(std::cos(turn) * front + std::sin(turn) * right);
    sky.view_.right = vec3(std::cos(turn) * right - std::sin(turn) * front);

    sky.view_.width = image.width;
    sky.view_.height = image.height;
    const std::shared_ptr<Picture> picture = distribute(std::move(image));
    sky.view_.pixels.at = picture->image.color.data();
    sky.picture_ = picture;
    sky.find_harmonics();
    return sky;
}

Sky Sky::scaled(float factor) const {
    Sky sky = *this;
    sky.view_.factor *= factor;
    for (vec3& c : sky.view_.harmonics) c *= factor;
    if (factor == 0.0f) sky.view_.kind = shared::kSkyBlack;
    return sky;
}

vec3 Sky::radiance(const vec3& direction) const {
    return shared::sky_radiance(view_, direction);
}

SkySample Sky::sample(const vec2& square) const {
    if (!uneven()) {
        const float z = 1.0f - 2.0f * square.x;
        const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
        const float angle = 2.0f * kPi * square.y;
        return {{radius * std::cos(angle), radius * std::sin(angle), z}, 1.0f / (4.0f * kPi)};
    }
    const SkyImage& image = picture_->image;
    const int y = find_interval(picture_->row_sums.data(), image.height, square.y);
    const float y_low = picture_->row_sums[static_cast<std::size_t>(y)];
    const float y_high = picture_->row_sums[static_cast<std::size_t>(y) + 1];
    const float* sums = picture_->column_sums.data() +
                        static_cast<std::size_t>(y) * (static_cast<std::size_t>(image.width) + 1);
    const int x = find_interval(sums, image.width, square.x);
    const float in_x = (square.x - sums[x]) / std::max(sums[x + 1] - sums[x], 1e-30f);
    const float in_y = (square.y - y_low) / std::max(y_high - y_low, 1e-30f);
    const float u =
        (static_cast<float>(x) + glm::clamp(in_x, 0.0f, 1.0f)) / static_cast<float>(image.width);
    const float v =
        (static_cast<float>(y) + glm::clamp(in_y, 0.0f, 1.0f)) / static_cast<float>(image.height);
    const float azimuth = 2.0f * kPi * (u - 0.5f);
    const float sine = std::sin(kPi * v);
    const vec3 direction = std::cos(kPi * v) * view_.up + sine * (std::cos(azimuth) * view_.front +
                                                                  std::sin(azimuth) * view_.right);
    return {direction, density(direction)};
}

float Sky::density(const vec3& direction) const {
    if (!uneven()) return 1.0f / (4.0f * kPi);
    const vec2 at = sky_place(view_, direction);
    const float sine = std::max(std::sin(kPi * at.y), 1e-6f);
    return picture_->density[static_cast<std::size_t>(sky_pixel_at(view_, at))] /
           (2.0f * kPi * kPi * sine);
}

vec3 Sky::diffuse(const vec3& normal) const {
    return shared::diffuse_sky(view_, normal);
}

void Sky::find_harmonics() {
    constexpr int kRows = 64;  // evenly spread by height, as a sphere's area is
    const int rows = picture_ ? std::max(kRows, picture_->image.height) : kRows;
    const int columns = 2 * rows;
    std::array<dvec3, 9> sums{};
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k < columns; ++k) {
            const float z = 1.0f - 2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(rows);
            const float radius = std::sqrt(1.0f - z * z);
            const float angle =
                2.0f * kPi * (static_cast<float>(k) + 0.5f) / static_cast<float>(columns);
            const vec3 d = z * view_.up +
                           radius * (std::cos(angle) * view_.front + std::sin(angle) * view_.right);
            const auto basis = harmonics(d);
            const dvec3 light(radiance(d));
            for (std::size_t n = 0; n < 9; ++n) sums[n] += light * static_cast<double>(basis[n]);
        }
    for (std::size_t n = 0; n < 9; ++n)
        view_.harmonics[n] = vec3(sums[n] * (4.0 * std::numbers::pi / (rows * columns)));
}

}  // namespace octavo
