// SPDX-License-Identifier: MIT
//
// How much do two pictures differ? usage: compare_images A.exr B.exr [EXPOSURE]
//
// Root mean square of linear light, as it is and as a part of the reference's mean (B is the
// reference), and FLIP of the tone-mapped pictures: Andersson, Nilsson, Akenine-Moeller, Oskarsson,
// Astroem, Fairchild, "FLIP: A Difference Evaluator for Alternating Images", HPG 2020. As there,
// for 67 pixels a degree.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "octavo/attributes/encodings.h"
#include "octavo/light/sky.h"
#include "octavo/render/tone_map.h"

namespace {

using octavo::vec3;

constexpr float kPixelsPerDegree = 67.0f;
constexpr float kPi = 3.14159265f;
const vec3 kWhite(0.950428545f, 1.0f, 1.088900371f);

struct Plane {
    int width, height;
    std::vector<vec3> values;
    const vec3& at(int x, int y) const {
        x = x < 0 ? 0 : x >= width ? width - 1 : x;
        y = y < 0 ? 0 : y >= height ? height - 1 : y;
        return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

vec3 to_xyz(const vec3& c) {
    return {0.4123907993f * c.r + 0.3575843394f * c.g + 0.1804807884f * c.b,
            0.2126390059f * c.r + 0.7151686788f * c.g + 0.0721923154f * c.b,
            0.0193308187f * c.r + 0.1191947798f * c.g + 0.9505321522f * c.b};
}
vec3 from_xyz(const vec3& c) {
    return {3.2409699419f * c.x - 1.5373831776f * c.y - 0.4986107603f * c.z,
            -0.9692436363f * c.x + 1.8759675015f * c.y + 0.0415550574f * c.z,
            0.0556300797f * c.x - 0.2039769589f * c.y + 1.0569715142f * c.z};
}
vec3 to_opponents(const vec3& rgb) {  // YCxCz
    const vec3 c = to_xyz(rgb) / kWhite;
    return {116.0f * c.y - 16.0f, 500.0f * (c.x - c.y), 200.0f * (c.y - c.z)};
}
vec3 from_opponents(const vec3& c) {
    const float y = (c.x + 16.0f) / 116.0f;
    return from_xyz(vec3(y + c.y / 500.0f, y, y - c.z / 200.0f) * kWhite);
}
vec3 to_hunt_lab(const vec3& rgb) {
    vec3 c = to_xyz(rgb) / kWhite;
    for (int i = 0; i < 3; ++i)
        c[i] = c[i] > 0.008856452f ? std::cbrt(c[i]) : c[i] / 0.128418549f + 4.0f / 29.0f;
    const float light = 116.0f * c.y - 16.0f;
    return {light, 0.01f * light * 500.0f * (c.x - c.y), 0.01f * light * 200.0f * (c.y - c.z)};
}
float distance(const vec3& a, const vec3& b) {  // HyAB, with the paper's exponent
    const vec3 d = a - b;
    return std::pow(std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z), 0.7f);
}

/// The eye's sensitivity to contrast: sums of two Gaussians for each channel.
Plane blur(const Plane& in) {
    constexpr std::array<std::array<float, 4>, 3> kTerms = {{{1.0f, 0.0047f, 0.0f, 1e-5f},
                                                             {1.0f, 0.0053f, 0.0f, 1e-5f},
                                                             {34.1f, 0.04f, 13.5f, 0.025f}}};
    const int radius = static_cast<int>(
        std::ceil(3.0f * std::sqrt(0.04f / (2.0f * kPi * kPi)) * kPixelsPerDegree));
    const auto side = 2 * static_cast<std::size_t>(radius) + 1;
    std::vector<vec3> weights(side * side);
    vec3 sum(0.0f);
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) {
            vec3& w = weights[static_cast<std::size_t>(y + radius) * side +
                              static_cast<std::size_t>(x + radius)];
            const float square =
                static_cast<float>(x * x + y * y) / (kPixelsPerDegree * kPixelsPerDegree);
            for (int c = 0; c < 3; ++c) {
                const auto& t = kTerms[static_cast<std::size_t>(c)];
                w[c] = t[0] * std::sqrt(kPi / t[1]) * std::exp(-kPi * kPi * square / t[1]) +
                       t[2] * std::sqrt(kPi / t[3]) * std::exp(-kPi * kPi * square / t[3]);
            }
            sum += w;
        }
    Plane out = in;
    std::size_t i = 0;
    for (int y = 0; y < in.height; ++y)
        for (int x = 0; x < in.width; ++x) {
            vec3 value(0.0f);
            for (int v = -radius; v <= radius; ++v)
                for (int u = -radius; u <= radius; ++u)
                    value += weights[static_cast<std::size_t>(v + radius) * side +
                                     static_cast<std::size_t>(u + radius)] *
                             in.at(x + u, y + v);
            out.values[i++] = value / sum;
        }
    return out;
}

/// Sizes of edges and points (first and second derivatives of a Gaussian) at a pixel, of lightness.
std::array<float, 2> features(const Plane& p, int x, int y) {
    constexpr float kWidth = 0.082f;
    const float deviation = 0.5f * kWidth * kPixelsPerDegree;
    const int radius = static_cast<int>(std::ceil(3.0f * deviation));
    std::array<float, 2> size{};
    for (int order = 0; order < 2; ++order) {
        float sums[2] = {0.0f, 0.0f}, above = 0.0f, below = 0.0f;
        for (int i = -radius; i <= radius; ++i)
            for (int k = -radius; k <= radius; ++k) {
                const float a = static_cast<float>(i), b = static_cast<float>(k);
                const float g = std::exp(-(a * a + b * b) / (2.0f * deviation * deviation));
                const float w = order == 0 ? -a * g : (a * a / (deviation * deviation) - 1.0f) * g;
                (w > 0.0f ? above : below) += std::abs(w);
            }
        for (int i = -radius; i <= radius; ++i)
            for (int k = -radius; k <= radius; ++k) {
                const float a = static_cast<float>(i), b = static_cast<float>(k);
                const float g = std::exp(-(a * a + b * b) / (2.0f * deviation * deviation));
                float w = order == 0 ? -a * g : (a * a / (deviation * deviation) - 1.0f) * g;
                w /= w > 0.0f ? above : below;
                sums[0] += w * (p.at(x + i, y + k).x + 16.0f) / 116.0f;
                sums[1] += w * (p.at(x + k, y + i).x + 16.0f) / 116.0f;
            }
        size[static_cast<std::size_t>(order)] = std::sqrt(sums[0] * sums[0] + sums[1] * sums[1]);
    }
    return size;
}

Plane shown(const octavo::SkyImage& image, float scale) {
    Plane plane{image.width, image.height, {}};
    for (const vec3& c : image.color) {
        const octavo::Rgb8 rgb = octavo::tone_map(c, scale);
        plane.values.push_back(to_opponents(octavo::linear_from_srgb8(rgb)));
    }
    return plane;
}

double flip(const Plane& a, const Plane& b) {
    const Plane seen_a = blur(a), seen_b = blur(b);
    const float most = distance(to_hunt_lab({0, 1, 0}), to_hunt_lab({0, 0, 1}));
    double sum = 0.0;
    std::size_t i = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x, ++i) {
            const vec3 none(0.0f), all(1.0f);
            float color =
                distance(to_hunt_lab(glm::clamp(from_opponents(seen_a.values[i]), none, all)),
                         to_hunt_lab(glm::clamp(from_opponents(seen_b.values[i]), none, all)));
            const float knee = 0.4f * most;
            color = color < knee ? 0.95f / knee * color
                                 : 0.95f + (color - knee) / (most - knee) * 0.05f;
            const auto fa = features(a, x, y), fb = features(b, x, y);
            const float feature = std::sqrt(
                std::max(std::abs(fa[0] - fb[0]), std::abs(fa[1] - fb[1])) / std::sqrt(2.0f));
            sum += static_cast<double>(std::pow(color, 1.0f - std::min(feature, 1.0f)));
        }
    return sum / static_cast<double>(a.values.size());
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fprintf(stderr, "usage: compare_images A.exr REFERENCE.exr [EXPOSURE]\n");
        return 2;
    }
    try {
        const octavo::SkyImage a = octavo::load_sky_image(argv[1]);
        const octavo::SkyImage b = octavo::load_sky_image(argv[2]);
        if (a.width != b.width || a.height != b.height) {
            std::fprintf(stderr, "compare_images: the pictures differ in size\n");
            return 3;
        }
        double square = 0.0, mean_a = 0.0, mean_b = 0.0;
        for (std::size_t i = 0; i < a.color.size(); ++i)
            for (int c = 0; c < 3; ++c) {
                const double d = static_cast<double>(a.color[i][c] - b.color[i][c]);
                square += d * d;
                mean_a += static_cast<double>(a.color[i][c]);
                mean_b += static_cast<double>(b.color[i][c]);
            }
        const double count = 3.0 * static_cast<double>(a.color.size());
        const double rmse = std::sqrt(square / count);
        const float scale = std::exp2(argc > 3 ? static_cast<float>(std::atof(argv[3])) : 0.0f);
        std::printf("rmse %.4f (%.3f of the mean), light %.3f of the reference, FLIP %.4f\n", rmse,
                    rmse / (mean_b / count), mean_a / mean_b,
                    flip(shown(a, scale), shown(b, scale)));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "compare_images: %s\n", error.what());
        return 3;
    }
    return 0;
}
