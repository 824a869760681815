// SPDX-License-Identifier: MIT
#include "octavo/render/lamp.h"

#include <algorithm>
#include <cmath>

namespace octavo {
namespace {

/// Rays from which on the two walks of a bundle cost less than they save.
constexpr int kRaysForABeam = 16;

float spot_falloff(const Light& light, const dvec3& from_light) {
    const double cosine = glm::dot(from_light, light.direction);
    const double outer = std::cos(light.outer_angle);
    const double inner = std::max(std::cos(light.inner_angle), outer + 1e-9);
    return static_cast<float>(glm::smoothstep(outer, inner, cosine));
}

}  // namespace

SeenLamp see_lamp(const Light& light, double size, const Grid& grid, const dvec3& from) {
    if (light.kind == Light::Kind::sun)
        return {{-vec3(light.direction), static_cast<float>(size), 1e30f}, 1.0f};
    const dvec3 way = grid.to_grid(light.position) - from;
    const double distance = glm::length(way) * grid.voxel_size;
    SeenLamp lamp{{vec3(way), static_cast<float>(size / grid.voxel_size), 1.0f},
                  static_cast<float>(1.0 / std::max(distance * distance, 1e-30))};
    if (light.kind == Light::Kind::spot) lamp.strength *= spot_falloff(light, -glm::normalize(way));
    return lamp;
}

void queue_lamp_rays(const shared::DagView& dag, const shared::GridRay& start, int face,
                     const shared::LampDisc& lamp, int first, int end, std::uint32_t seed,
                     bool beam, RayQueue& queue) {
    constexpr shared::Stop kToVoxels{0, 0.0f, 0.0f};
    float t_min = start.t_min;
    float t_max = lamp.t_end;
    if (beam && end - first >= kRaysForABeam) {
        shared::Bundle bundle = lamp_bundle(start, face, lamp);
        t_min = bundle.t_min = beam_start(dag, bundle, kToVoxels);
        if (t_min < t_max) t_max = beam_end(dag, bundle, kToVoxels);
        if (!(t_min < t_max)) return queue.add_seen(end - first);
    }
    for (int i = first; i < end; ++i) {
        shared::GridRay ray = lamp_ray(start, face, lamp, i, seed);
        ray.t_min = t_min;
        ray.t_max = t_max;
        queue.add(ray);
    }
}

}  // namespace octavo
