// SPDX-License-Identifier: MIT
#include "octavo/attributes/surface_sampler.h"

#include <algorithm>
#include <cmath>

namespace octavo {
namespace {

const Material kPlain;

const Material& material_of(const Scene& scene, std::size_t triangle) {
    if (scene.triangle_materials.empty()) return kPlain;
    const std::uint32_t index = scene.triangle_materials[triangle];
    return index < scene.materials.size() ? scene.materials[index] : kPlain;
}

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
}

SurfaceSampler::Triangle SurfaceSampler::prepare(std::size_t triangle,
                                                 const std::array<dvec3, 3>& corners) const {
    Triangle t;
    const Material& material = material_of(scene_, triangle);
    t.weights_ = barycentric_weights(corners);
    for (int i = 0; i < 3; ++i) {
        vec4 color = material.base_color;
        if (!scene_.colors.empty()) {
            const auto& c = scene_.colors[scene_.triangles[triangle][i]];
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
    return t;
}

SurfaceSample SurfaceSampler::Triangle::at(const dvec3& point) const {
    SurfaceSample sample;
    vec4 color = corner_colors_[0];
    if (!one_color_) {
        const dvec4 p(point, 1.0);
        const auto b = static_cast<float>(std::clamp(glm::dot(weights_[0], p), 0.0, 1.0));
        const auto c = static_cast<float>(std::clamp(glm::dot(weights_[1], p), 0.0, 1.0));
        color = (1.0f - b - c) * color + b * corner_colors_[1] + c * corner_colors_[2];
    }
    for (int i = 0; i < 3; ++i) {
        sample.color[static_cast<unsigned>(i)] = part_of(color[i], 65535.0f);
        if (emits_) sample.emission[static_cast<unsigned>(i)] = part_of(emission_[i], 1048576.0f);
    }
    return sample;
}

}  // namespace octavo
