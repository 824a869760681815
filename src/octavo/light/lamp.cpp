// SPDX-License-Identifier: MIT
#include "octavo/light/lamp.h"

#include <algorithm>
#include <cmath>

namespace octavo {
namespace {

/// A cell beyond this is out of the reach of whole numbers; a lamp there is moved to it.
constexpr double kFarthest = 1 << 29;

/// A place in grid space as cell + frac.
void split(const dvec3& at, ivec3& cell, vec3& frac) {
    const dvec3 near = glm::clamp(at, -kFarthest, kFarthest);
    const dvec3 whole = glm::floor(near);
    cell = ivec3(whole);
    frac = vec3(near - whole);
}

int kind_of(Light::Kind kind) {
    switch (kind) {
        case Light::Kind::sun:
            return shared::kSunLamp;
        case Light::Kind::point:
        case Light::Kind::spot:
            return shared::kPointLamp;
        case Light::Kind::mesh:
            return shared::kMeshLamp;
        default:
            return shared::kPatchLamp;
    }
}

float patch_area(const shared::LampPatch& patch) {
    const double parallelogram = glm::length(glm::cross(dvec3(patch.u), dvec3(patch.v)));
    return static_cast<float>(parallelogram *
                              (patch.shape == shared::kDiscShape ? 3.141592653589793 : 4.0));
}

}  // namespace

Lamp::Lamp(const Light& light, const Grid& grid) : light_(light) {
    shared::PlacedLamp& p = placed_;
    p.kind = kind_of(light.kind);
    split(grid.to_grid(light.position), p.cell, p.frac);
    p.direction = vec3(light.direction);
    p.voxel_size = static_cast<float>(grid.voxel_size);
    p.radius = static_cast<float>(light.kind == Light::Kind::sun ? light.size
                                                                 : light.size / grid.voxel_size);
    p.cos_inner = p.cos_outer = -2.0f;
    if (light.kind == Light::Kind::spot) {
        p.cos_outer = static_cast<float>(std::cos(light.outer_angle));
        p.cos_inner =
            std::max(static_cast<float>(std::cos(light.inner_angle)), p.cos_outer + 1e-6f);
    }
    if (light.kind == Light::Kind::disc || light.kind == Light::Kind::rectangle) {
        shared::LampPatch patch = shared::facing_disc(-p.direction, p.radius, 1.0f);
        if (light.kind == Light::Kind::rectangle) {
            patch.u = vec3(light.half_u / grid.voxel_size);
            patch.v = vec3(light.half_v / grid.voxel_size);
            patch.shape = shared::kRectangleShape;
        }
        p.u = patch.u;
        p.v = patch.v;
        p.shape = patch.shape;
        p.area = patch_area(patch);
    }
    if (light.kind == Light::Kind::mesh) place_triangles(grid);
}

void Lamp::place_triangles(const Grid& grid) {
    Box box;
    for (const auto& corners : light_.triangles)
        for (const dvec3& corner : corners)
            if (std::isfinite(glm::dot(corner, corner))) box.extend(grid.to_grid(corner));
    const dvec3 middle = box.empty() ? dvec3(0.0) : box.centre();
    split(middle, placed_.cell, placed_.frac);
    // Some bits more, for the rounding to float.
    placed_.low = vec3(box.low - middle) * 1.00001f - 1e-2f;
    placed_.high = vec3(box.high - middle) * 1.00001f + 1e-2f;
    double area = 0.0;
    for (const auto& corners : light_.triangles) {
        const dvec3 at = grid.to_grid(corners[0]);
        const dvec3 u = grid.to_grid(corners[1]) - at;
        const dvec3 v = grid.to_grid(corners[2]) - at;
        const dvec3 normal = glm::cross(u, v);
        const double length = glm::length(normal);
        if (!(length > 0.0) || !std::isfinite(length)) continue;
        shared::LampTriangle triangle{};
        split(at, triangle.cell, triangle.frac);
        triangle.u = vec3(u);
        triangle.v = vec3(v);
        triangle.normal = vec3(normal / length);
        triangle.middle = vec3(at - middle) + (triangle.u + triangle.v) / 3.0f;
        triangle.squared = static_cast<float>(length);
        triangle.area_so_far = static_cast<float>(area += 0.5 * length);
        triangles_.push_back(triangle);
    }
    placed_.triangle_count = static_cast<int>(triangles_.size());
    placed_.area = static_cast<float>(area);
}

float queue_lamp_rays(const SeenLamp& lamp, int first, int end, std::uint32_t seed,
                      RayQueue& queue) {
    float all = 0.0f;
    if (lamp.dark()) return all;
    for (int i = first; i < end; ++i) {
        const shared::LampSample sample = lamp.ray(i, seed);
        if (!(sample.light > 0.0f)) continue;
        all += sample.light;
        queue.add(sample.ray, sample.light);
    }
    return all;
}

}  // namespace octavo
