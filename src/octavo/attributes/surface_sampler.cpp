// SPDX-License-Identifier: MIT
#include "octavo/attributes/surface_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "octavo/mesh/alpha.h"

namespace octavo {
namespace {

// A texel that is as wide as the cell, with the tent that is between texels, would blur more than
// the cell does: of equal variance is one sqrt(3) narrower. log2 of that.
constexpr double kTentBias = -0.79;
constexpr int kMostSamples = 8;

float finite_or_zero(float x) {
    return std::isfinite(x) ? x : 0.0f;
}

std::uint32_t part_of(float x, float whole) {
    return static_cast<std::uint32_t>(std::clamp(x, 0.0f, 1.0f) * whole + 0.5f);
}

/// The weights of corners 1 and 2 at a point p of the triangle's plane: dot(w, (p, 1)).
std::array<dvec4, 2> barycentric_weights(const std::array<dvec3, 3>& c) {
    const dvec3 a = c[1] - c[0], b = c[2] - c[0];
    const dvec3 normal = glm::cross(a, b);
    const double square = glm::dot(normal, normal);
    if (!(square > 0.0)) return {};
    const dvec3 first = glm::cross(b, normal) / square;   // is 1 along a and 0 along b
    const dvec3 second = glm::cross(normal, a) / square;  // and the other way around
    return {dvec4(first, -glm::dot(first, c[0])), dvec4(second, -glm::dot(second, c[0]))};
}

}  // namespace

SurfaceSampler::SurfaceSampler(const Scene& scene) : scene_(scene) {
    for (const Material& m : scene.materials)
        for (int i = 0; i < 3; ++i)
            greatest_emission_ = std::max(greatest_emission_, finite_or_zero(m.emission[i]));

    // What is asked for is known beforehand, so that later everything is read only.
    std::set<std::pair<int, int>> wanted;
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        const Material& m = material_of(scene, t);
        if (m.base_color_texture != Material::kNoTexture)
            wanted.emplace(m.base_color_texture, std::min(255, least_alpha(scene, t)));
        if (m.emission_texture != Material::kNoTexture && m.emission != vec3(0.0f))
            wanted.emplace(m.emission_texture, 0);
    }
    std::vector<std::pair<int, int>> keys;
    for (const auto& key : wanted)
        if (!scene.texture_coordinates.empty() && decoded_texture(scene, key.first))
            keys.push_back(key);
    std::vector<std::optional<MipTexture>> made(keys.size());
    tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t i) {
        made[i].emplace(*decoded_texture(scene, keys[i].first), keys[i].second);
    });
    for (std::size_t i = 0; i < keys.size(); ++i) textures_.emplace(keys[i], std::move(*made[i]));
}

const MipTexture* SurfaceSampler::mip_texture(int texture, int least_alpha) const {
    const auto found = textures_.find({texture, least_alpha});
    return found == textures_.end() ? nullptr : &found->second;
}

SurfaceSampler::Triangle SurfaceSampler::prepare(std::size_t triangle,
                                                 const std::array<dvec3, 3>& corners,
                                                 double footprint) const {
    Triangle t;
    const Material& material = material_of(scene_, triangle);
    const uvec3& vertices = scene_.triangles[triangle];
    t.weights_ = barycentric_weights(corners);
    for (int i = 0; i < 3; ++i) {
        vec4 color = material.base_color;
        if (!scene_.colors.empty()) {
            const auto& c = scene_.colors[vertices[i]];
            color *= vec4(c[0], c[1], c[2], c[3]) / 255.0f;
        }
        t.corner_colors_[static_cast<unsigned>(i)] = color;
    }
    t.one_color_ =
        t.corner_colors_[0] == t.corner_colors_[1] && t.corner_colors_[0] == t.corner_colors_[2];
    if (greatest_emission_ > 0.0f) {
        t.emission_ = material.emission / greatest_emission_;
        t.emits_ = t.emission_ != vec3(0.0f);
    }
    if (textures_.empty()) return t;

    const int holes = std::min(255, least_alpha(scene_, triangle));
    t.has_holes_ = holes > 0;
    t.base_.texture = mip_texture(material.base_color_texture, holes);
    if (t.emits_) t.glow_.texture = mip_texture(material.emission_texture, 0);
    if (!t.base_.texture && !t.glow_.texture) return t;

    const glm::dvec2 first(scene_.texture_coordinates[vertices.x]);
    const glm::dvec2 a = glm::dvec2(scene_.texture_coordinates[vertices.y]) - first;
    const glm::dvec2 b = glm::dvec2(scene_.texture_coordinates[vertices.z]) - first;
    if (!std::isfinite(first.x + first.y + a.x + a.y + b.x + b.y)) {
        t.base_.texture = t.glow_.texture = nullptr;
        return t;
    }
    for (int i = 0; i < 2; ++i)
        t.coordinates_[static_cast<unsigned>(i)] =
            a[i] * t.weights_[0] + b[i] * t.weights_[1] + dvec4(0.0, 0.0, 0.0, first[i]);
    for (Triangle::Filter* filter : {&t.base_, &t.glow_})
        if (filter->texture) choose_filter(*filter, t.coordinates_, footprint);
    return t;
}

/// The footprint of a piece in the texture is an ellipse: samples as wide as it is narrow, side by
/// side along its length.
void SurfaceSampler::choose_filter(Triangle::Filter& filter,
                                   const std::array<dvec4, 2>& coordinates, double footprint) {
    const glm::dvec2 size(filter.texture->width(), filter.texture->height());
    const dvec3 u = dvec3(coordinates[0]) * size.x * footprint;  // texels along a piece
    const dvec3 v = dvec3(coordinates[1]) * size.y * footprint;
    const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v);
    const double middle = 0.5 * (uu + vv), reach = std::hypot(0.5 * (uu - vv), uv);
    const double length = std::sqrt(middle + reach);
    const double width = std::sqrt(std::max(middle - reach, 0.0));
    if (!(length > 0.0) || !std::isfinite(length)) return;

    // A piece narrower than a texel needs no narrower samples.
    const double ratio = length / std::max({width, 1.0, length / kMostSamples});
    filter.samples = std::clamp(static_cast<int>(std::ceil(ratio - 0.25)), 1, kMostSamples);
    filter.level = static_cast<int>(
        std::clamp(std::round(std::log2(length / filter.samples) + kTentBias), 0.0, 31.0));
    filter.share = 1.0f / static_cast<float>(filter.samples);
    if (filter.samples == 1) return;
    const glm::dvec2 long_way = std::abs(uv) > 1e-12 * middle
                                    ? glm::normalize(glm::dvec2(uv, middle + reach - uu))
                                : uu >= vv ? glm::dvec2(1.0, 0.0)
                                           : glm::dvec2(0.0, 1.0);
    filter.step = long_way * (length / filter.samples) / size;
}

template <class Look>
void SurfaceSampler::Triangle::for_samples(const Filter& filter, const dvec4& point,
                                           const Look& look) const {
    const glm::dvec2 middle(glm::dot(coordinates_[0], point), glm::dot(coordinates_[1], point));
    for (int i = 0; i < filter.samples; ++i)
        look(middle + (i - 0.5 * (filter.samples - 1)) * filter.step);
}

SurfaceSample SurfaceSampler::Triangle::at(const dvec3& point) const {
    SurfaceSample sample;
    const dvec4 p(point, 1.0);
    vec4 color = corner_colors_[0];
    if (!one_color_) {
        const auto b = static_cast<float>(std::clamp(glm::dot(weights_[0], p), 0.0, 1.0));
        const auto c = static_cast<float>(std::clamp(glm::dot(weights_[1], p), 0.0, 1.0));
        color = (1.0f - b - c) * color + b * corner_colors_[1] + c * corner_colors_[2];
    }
    vec3 base(color);
    if (base_.texture) {
        vec4 sum(0.0f);
        for_samples(base_, p,
                    [&](const glm::dvec2& at) { sum += base_.texture->sample(at, base_.level); });
        if (!has_holes_) {
            base *= vec3(sum) * base_.share;
        } else if (sum.a > 1e-5f) {
            base *= vec3(sum) / sum.a;
        } else {
            base *= base_.texture->color_around(
                {glm::dot(coordinates_[0], p), glm::dot(coordinates_[1], p)});
        }
        if (has_holes_)
            sample.opacity = static_cast<std::uint16_t>(part_of(sum.a * base_.share, 65535.0f));
    }
    vec3 glow = emission_;
    if (glow_.texture) {
        vec4 sum(0.0f);
        for_samples(glow_, p,
                    [&](const glm::dvec2& at) { sum += glow_.texture->sample(at, glow_.level); });
        glow *= vec3(sum) * glow_.share;
    }
    for (int i = 0; i < 3; ++i) {
        sample.color[static_cast<unsigned>(i)] =
            static_cast<std::uint16_t>(part_of(base[i], 65535.0f));
        if (emits_) sample.emission[static_cast<unsigned>(i)] = part_of(glow[i], 1048576.0f);
    }
    return sample;
}

}  // namespace octavo
