// SPDX-License-Identifier: MIT
#include "octavo/mesh/mesh_lamps.h"

#include <algorithm>
#include <cmath>

namespace octavo {
namespace {

double area(const std::array<dvec3, 3>& t) {
    return 0.5 * glm::length(glm::cross(t[1] - t[0], t[2] - t[0]));
}

bool shines(const Material& material) {
    const vec3& e = material.emission;
    return material.emission_texture == Material::kNoTexture && std::isfinite(e.x + e.y + e.z) &&
           std::max({e.x, e.y, e.z}) > 0.0f;
}

double total_area(const std::vector<std::array<dvec3, 3>>& triangles) {
    double sum = 0.0;
    for (const auto& t : triangles) sum += area(t);
    return sum;
}

/// The largest triangles, in their old order.
void keep_largest(Light& lamp, std::size_t count) {
    const double whole = total_area(lamp.triangles);
    std::vector<double> areas;
    for (const auto& t : lamp.triangles) areas.push_back(area(t));
    std::vector<std::size_t> order(areas.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, [&](auto a, auto b) { return areas[a] > areas[b]; });
    order.resize(count);
    std::ranges::sort(order);
    std::vector<std::array<dvec3, 3>> kept;
    for (const std::size_t i : order) kept.push_back(lamp.triangles[i]);
    lamp.triangles = std::move(kept);
    lamp.intensity *= static_cast<float>(whole / total_area(lamp.triangles));
}

}  // namespace

std::vector<Light> mesh_lamps(const Scene& scene, std::size_t most) {
    std::vector<Light> by_material(scene.materials.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < scene.triangle_materials.size(); ++i) {
        const std::uint32_t material = scene.triangle_materials[i];
        if (material == Scene::kNoMaterial || !shines(scene.materials[material])) continue;
        const auto corners = scene.corners(i);
        const double size = area(corners);
        if (!(size > 0.0) || !std::isfinite(size)) continue;
        by_material[material].triangles.push_back(corners);
        ++count;
    }
    std::vector<Light> lamps;
    for (std::size_t m = 0; m < by_material.size(); ++m) {
        Light& lamp = by_material[m];
        if (lamp.triangles.empty()) continue;
        lamp.name = scene.materials[m].name;
        lamp.kind = Light::Kind::mesh;
        lamp.intensity = scene.materials[m].emission;
        const std::size_t share = std::max<std::size_t>(1, most * lamp.triangles.size() / count);
        if (count > most && lamp.triangles.size() > share) keep_largest(lamp, share);
        lamps.push_back(std::move(lamp));
    }
    return lamps;
}

}  // namespace octavo
