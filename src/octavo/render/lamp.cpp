// SPDX-License-Identifier: MIT
#include "octavo/render/lamp.h"

#include <algorithm>
#include <cmath>

namespace octavo {
namespace {

/// Rays from which on the two walks of a bundle cost less than they save.
constexpr int kRaysForABeam = 16;

/// Voxels above a lamp's surface where rays to it end: above the square root of 3, the farthest
/// that a voxel which touches the surface reaches.
constexpr float kAboveLamp = 1.75f;

/// For the choice of a triangle; the place on it takes the seed as it is.
constexpr std::uint32_t kTriangleSeed = 0x7f4a7c15u;

/// Triangles that a ray chooses among, and what makes the choice.
constexpr int kCandidates = 8;
constexpr std::uint32_t kChoiceSeed = 0x1b56c4e9u;

float spot_falloff(const Light& light, const dvec3& from_light) {
    const double cosine = glm::dot(from_light, light.direction);
    const double outer = std::cos(light.outer_angle);
    const double inner = std::max(std::cos(light.inner_angle), outer + 1e-9);
    return static_cast<float>(glm::smoothstep(outer, inner, cosine));
}

double patch_area(const shared::LampPatch& patch) {
    const double parallelogram = glm::length(glm::cross(dvec3(patch.u), dvec3(patch.v)));
    return parallelogram * (patch.shape == shared::kDiscShape ? 3.141592653589793 : 4.0);
}

}  // namespace

Lamp::Lamp(const Light& light, const Grid& grid) : light_(light), grid_(grid) {
    Box box;
    double sum = 0.0;
    for (const auto& corners : light.triangles) {
        const dvec3 at = grid.to_grid(corners[0]);
        const dvec3 u = grid.to_grid(corners[1]) - at;
        const dvec3 v = grid.to_grid(corners[2]) - at;
        const dvec3 normal = glm::cross(u, v);
        const double length = glm::length(normal);
        if (!(length > 0.0) || !std::isfinite(length)) continue;
        for (const dvec3& corner : {at, at + u, at + v}) box.extend(corner);
        triangles_.push_back(
            {at, vec3(u), vec3(v), vec3(normal / length), vec3(0.0f), static_cast<float>(length)});
        areas_.push_back(sum += 0.5 * length);
    }
    if (!box.empty()) {
        low_ = box.low;
        high_ = box.high;
    }
    for (Triangle& t : triangles_) t.middle = vec3(t.corner - low_) + (t.u + t.v) / 3.0f;
}

SeenLamp::SeenLamp(const Lamp& lamp, const shared::GridRay& start, int face, const vec3& normal,
                   bool hard)
    : lamp_(lamp), start_(start), face_(face), normal_(normal) {
    const Light& light = lamp.light_;
    const Grid& grid = lamp.grid_;
    const double size = hard ? 0.0 : light.size;
    const dvec3 from = dvec3(start.cell) + dvec3(start.frac);
    if (light.kind == Light::Kind::mesh) {
        dark_ = lamp.triangles_.empty();
        to_low_ = vec3(lamp.low_ - from);
        return;
    }
    if (light.kind == Light::Kind::sun) {
        patch_ = shared::facing_disc(-vec3(light.direction), static_cast<float>(size), 1e30f);
        light_ = glm::dot(normal, patch_.centre);
        dark_ = !(light_ > 0.0f);
        return;
    }
    dvec3 way = grid.to_grid(light.position) - from;
    if (light.kind == Light::Kind::point || light.kind == Light::Kind::spot) {
        const double distance = std::max(glm::length(way) * grid.voxel_size, 1e-15);
        patch_ = shared::facing_disc(vec3(way), static_cast<float>(size / grid.voxel_size), 1.0f);
        light_ = glm::dot(normal, vec3(glm::normalize(way))) *
                 static_cast<float>(1.0 / (distance * distance));
        if (light.kind == Light::Kind::spot) light_ *= spot_falloff(light, -glm::normalize(way));
        dark_ = !(light_ > 0.0f);
        return;
    }
    const bool disc = light.kind == Light::Kind::disc;
    dark_ = glm::dot(way, light.direction) >= 0.0;  // behind it
    way += static_cast<double>(kAboveLamp) * light.direction;
    patch_ = shared::facing_disc(-vec3(light.direction),
                                 static_cast<float>(light.size / grid.voxel_size), 1.0f);
    patch_.centre = vec3(way);
    if (!disc) {
        patch_.u = vec3(light.half_u / grid.voxel_size);
        patch_.v = vec3(light.half_v / grid.voxel_size);
        patch_.shape = shared::kRectangleShape;
    }
    if (hard) {
        light_ = area_light(patch_.centre, vec3(light.direction), patch_area(patch_));
        patch_.u = patch_.v = vec3(0.0f);
        dark_ = dark_ || !(light_ > 0.0f);
    }
}

/// What a radiance of 1 that leaves `area` square voxels in all directions brings to the point.
///
/// @param direction  of the ray, which ends above the lamp
float SeenLamp::area_light(const vec3& direction, const vec3& lamp_normal, double area) const {
    const vec3 way = direction - kAboveLamp * lamp_normal;
    const float squared = std::max(glm::dot(way, way), kAboveLamp * kAboveLamp);
    const float at_point = std::max(0.0f, glm::dot(way, normal_));
    const float at_lamp = std::max(0.0f, -glm::dot(way, lamp_normal));
    return static_cast<float>(area) * at_point * at_lamp / (squared * squared);
}

LampRay SeenLamp::ray(int i, std::uint32_t seed) const {
    const Light& light = lamp_.light_;
    if (light.kind == Light::Kind::mesh) return triangle_ray(i, seed);
    const shared::GridRay ray = lamp_ray(start_, face_, patch_, i, seed);
    if (light_ > 0.0f) return {ray, light_};
    return {ray, area_light(ray.dir, vec3(light.direction), patch_area(patch_))};
}

/// A point of one triangle. Some triangles are drawn by their area, and one of these by its
/// distance: where a lamp is spread over the scene, say all lanterns of a street, most rays so go
/// to what is near. After Talbot, Cline and Egbert, "Importance Resampling for Global
/// Illumination", 2005.
LampRay SeenLamp::triangle_ray(int i, std::uint32_t seed) const {
    const auto number = static_cast<std::uint32_t>(i);
    const float place = shared::sample_1d(number, seed ^ kTriangleSeed);
    float left = shared::sample_1d(number, seed ^ kChoiceSeed);
    const Lamp::Triangle* chosen = nullptr;
    float sum = 0.0f;
    float weight = 0.0f;
    for (int k = 0; k < kCandidates; ++k) {
        const double area =
            lamp_.areas_.back() * static_cast<double>(place + float(k)) / kCandidates;
        const auto at = std::ranges::upper_bound(lamp_.areas_, area) - lamp_.areas_.begin();
        const Lamp::Triangle& next =
            lamp_.triangles_[std::min(static_cast<std::size_t>(at), lamp_.triangles_.size() - 1)];
        const vec3 way = to_low_ + next.middle;
        const float by_distance = 1.0f / (glm::dot(way, way) + next.squared);
        sum += by_distance;
        // The random number is used up bit by bit: what is left of it is even in [0, 1) again.
        const float share = by_distance / sum;
        if (left < share) {
            chosen = &next;
            weight = by_distance;
            left /= share;
        } else {
            left = (left - share) / (1.0f - share);
        }
    }
    const dvec3 way = chosen->corner - dvec3(start_.cell) - dvec3(start_.frac);
    const bool behind = glm::dot(vec3(way), chosen->normal) > 0.0f;
    const vec3 normal = behind ? -chosen->normal : chosen->normal;
    const shared::LampPatch patch{vec3(way) + kAboveLamp * normal, chosen->u, chosen->v,
                                  shared::kTriangleShape, 1.0f};
    const shared::GridRay ray = lamp_ray(start_, face_, patch, i, seed);
    const float share = sum / (static_cast<float>(kCandidates) * weight);
    return {ray, share * area_light(ray.dir, normal, lamp_.areas_.back())};
}

shared::Bundle SeenLamp::bundle() const {
    if (lamp_.light_.kind != Light::Kind::mesh) return lamp_bundle(start_, face_, patch_);
    const dvec3 from = dvec3(start_.cell) + dvec3(start_.frac);
    const double above = 1.001 * static_cast<double>(kAboveLamp);
    return shared::shadow_bundle(start_, face_, vec3(lamp_.low_ - from - above),
                                 vec3(lamp_.high_ - from + above), 1.0f);
}

float queue_lamp_rays(const shared::DagView& dag, const SeenLamp& lamp, int first, int end,
                      std::uint32_t seed, bool beam, RayQueue& queue) {
    constexpr shared::Stop kToVoxels{0, 0.0f, 0.0f};
    float all = 0.0f;
    if (lamp.dark()) return all;
    float t_min = 0.0f;
    float t_max = 1e30f;
    if (beam && end - first >= kRaysForABeam) {
        shared::Bundle bundle = lamp.bundle();
        t_min = bundle.t_min = beam_start(dag, bundle, kToVoxels);
        if (t_min < bundle.t_max) t_max = beam_end(dag, bundle, kToVoxels);
        if (!(t_min < t_max)) t_max = t_min;
    }
    for (int i = first; i < end; ++i) {
        LampRay sample = lamp.ray(i, seed);
        if (!(sample.light > 0.0f)) continue;
        all += sample.light;
        sample.ray.t_min = std::max(sample.ray.t_min, t_min);
        sample.ray.t_max = std::min(sample.ray.t_max, t_max);
        if (sample.ray.t_min < sample.ray.t_max)
            queue.add(sample.ray, sample.light);
        else
            queue.add_seen(sample.light);
    }
    return all;
}

}  // namespace octavo
