// SPDX-License-Identifier: MIT
#include "octavo/light/emitters.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "octavo/light/point_text.h"

namespace octavo {
namespace {

double luminance(const vec3& c) {
    return static_cast<double>(glm::dot(c, vec3(0.2126f, 0.7152f, 0.0722f)));
}

/// 1 - cos of the half angle of the cone around a ball, exact for far ones too; 2: all directions.
double cone_of(const dvec3& way, double radius) {
    const double square = glm::dot(way, way);
    const double sine2 = radius * radius / std::max(square, 1e-300);
    if (sine2 >= 1.0) return 2.0;
    return sine2 / (1.0 + std::sqrt(1.0 - sine2));
}

}  // namespace

Emitters::Emitters(const LitScene& scene, const Instances& world) {
    double total = 0.0;
    for (std::uint32_t object = 0; object < scene.objects.size(); ++object) {
        const Attributes& attributes = scene.objects[object].attributes;
        if (!attributes.has_emission()) continue;
        const CellIndex& cells = attributes.cells();
        const double width = std::ldexp(1.0, cells.dag().depth() - cells.level());
        const dmat4& to_common = world.to_common(object);
        double scale = 0.0;
        for (int i = 0; i < 3; ++i) scale = std::max(scale, glm::length(dvec3(to_common[i])));
        cells.for_each({0, cells.count()}, [&](std::uint64_t cell, const uvec3& at) {
            double light = 0.0;
            for (int face = 0; face < 6; ++face) {
                vec3 towards(0.0f);
                towards[face / 2] = (face & 1) == 1 ? 1.0f : -1.0f;
                light = std::max(light, luminance(attributes.emission(cell, towards)));
            }
            if (!(light > 0.0)) return;
            const dvec3 centre(to_common * dvec4((dvec3(at) + 0.5) * width, 1.0));
            const double radius = 0.8661 * width * scale;
            bounds_.extend(centre - radius);
            bounds_.extend(centre + radius);
            emitters_.push_back(
                {object, cell, centre, radius, static_cast<float>(light * radius * radius)});
            total += light * radius * radius;
        });
    }
    double sum = 0.0;
    for (Emitter& emitter : emitters_) {
        sum += static_cast<double>(emitter.part);
        sums_.push_back(sum / total);
        emitter.part = static_cast<float>(static_cast<double>(emitter.part) / total);
    }
    if (!sums_.empty()) sums_.back() = 1.0;
}

Emitters::Sample Emitters::sample(const dvec3& from, float choice, const vec2& square) const {
    const auto at = std::ranges::upper_bound(sums_, static_cast<double>(choice)) - sums_.begin();
    const Emitter& e = emitters_[std::min(static_cast<std::size_t>(at), emitters_.size() - 1)];
    const dvec3 way = e.centre - from;
    const double cone = cone_of(way, e.radius);
    const double height = 1.0 - cone * static_cast<double>(square.x);
    const double radius = std::sqrt(std::max(0.0, 1.0 - height * height));
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(square.y);
    const vec3 axis = cone < 2.0 ? vec3(glm::normalize(way)) : vec3(0.0f, 0.0f, 1.0f);
    const vec3 direction = shared::from_frame(
        axis, vec3(dvec3(radius * std::cos(angle), radius * std::sin(angle), height)));
    return {direction,
            static_cast<float>(static_cast<double>(e.part) / (2.0 * std::numbers::pi * cone)),
            e.object, e.cell};
}

float Emitters::density(const dvec3& from, std::uint32_t object, std::uint64_t cell) const {
    const auto found =
        std::ranges::lower_bound(emitters_, std::tuple(object, cell), {},
                                 [](const Emitter& e) { return std::tuple(e.object, e.cell); });
    if (found == emitters_.end() || found->object != object || found->cell != cell) return 0.0f;
    const double cone = cone_of(found->centre - from, found->radius);
    return static_cast<float>(static_cast<double>(found->part) / (2.0 * std::numbers::pi * cone));
}

}  // namespace octavo
