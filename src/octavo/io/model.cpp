// SPDX-License-Identifier: MIT
#include "octavo/io/model.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "octavo/mesh/mesh_lamps.h"

namespace octavo {
namespace {

template <typename Vector>
bool finite(const Vector& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool usable(const Camera& camera) {
    return finite(camera.eye) && finite(camera.forward) && finite(camera.up) &&
           std::isfinite(camera.vertical_fov);
}

bool usable(const Light& light) {
    return finite(light.position) && finite(light.direction) && finite(light.intensity) &&
           std::isfinite(light.inner_angle) && std::isfinite(light.outer_angle) &&
           std::isfinite(light.size) && finite(light.half_u) && finite(light.half_v);
}

template <typename Item>
std::vector<Item> usable_ones(const std::vector<Item>& all) {
    std::vector<Item> kept;
    std::copy_if(all.begin(), all.end(), std::back_inserter(kept),
                 [](const Item& item) { return usable(item); });
    return kept;
}

}  // namespace

Model make_model(std::string source, const Scene& scene, VoxelRule rule, BuildResult built) {
    Model model;
    model.metadata.source = std::move(source);
    model.metadata.rule = rule;
    model.metadata.grid = built.grid;
    model.metadata.triangles = built.triangles;
    model.metadata.degenerate_triangles = built.degenerate_triangles;
    model.metadata.non_finite_triangles = built.non_finite_triangles;
    model.metadata.cameras = usable_ones(scene.cameras);
    model.metadata.lights = usable_ones(scene.lights);
    std::ranges::move(mesh_lamps(scene), std::back_inserter(model.metadata.lights));
    const bool counted = !built.statistics.levels.empty();
    model.metadata.statistics =
        counted ? std::move(built.statistics) : compute_statistics(built.dag);
    model.dag = std::move(built.dag);
    return model;
}

}  // namespace octavo
