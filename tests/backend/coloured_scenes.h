// SPDX-License-Identifier: MIT
#pragma once

#include <random>
#include <string>

#include "octavo/attributes/build_attributes.h"
#include "octavo/attributes/cell_values_writer.h"
#include "octavo/construct/build.h"
#include "octavo/light/light_cells.h"
#include "octavo/mesh/samples.h"
#include "octavo/render/render.h"
#include "support/small_dags.h"

namespace octavo::test {

/// A DAG with what its cells look like and what light they have.
struct ColouredScene {
    std::string name;
    Dag dag;
    Grid grid;
    Attributes attributes;
    CellLight light;
};

/// Any bits in every channel: many colours and few, backs, emission, hidden sides.
inline ColouredScene random_colours(const Dag& dag, int level, std::uint32_t seed) {
    std::mt19937 random(seed);
    const CellIndex cells(dag, level);
    std::array<CellValues, Attributes::kChannels> channels;
    for (std::size_t c = 0; c < 4; ++c) {
        CellValuesWriter writer(Attributes::kValueBits[c], 0);
        for (std::uint64_t i = 0; i < cells.count(); ++i) {
            auto value = static_cast<std::uint32_t>(random());
            if (i / 700 % 2 != 0) value &= 0x00030101u;
            if (c == 0) value &= 0xffffffu;
            // An exponent that leaves the picture finite; half of the cells do not shine.
            if (c >= 2) value = random() % 2 == 0 ? 0 : ((value & 0x7ffffffu) | 14u << 27);
            if (c == 1)
                value = random() % 3 != 0 ? 0
                                          : pack_back(value & 0xffffffu,
                                                      static_cast<std::uint32_t>(random() % 121));
            writer.append(std::span(&value, 1));
        }
        channels[c] = std::move(writer).finish();
    }
    std::vector<std::uint32_t> light;
    for (std::uint64_t i = 0; i < 6 * cells.count(); ++i)
        light.push_back(random() % 4 == 0 ? CellLight::kHidden
                                          : ((random() & 0x7ffffffu) | 14u << 27));
    const double size = 8.0 / static_cast<double>(dag.resolution());
    return {
        "random colours at level " + std::to_string(level) + " of " + std::to_string(dag.depth()),
        dag,
        {.origin = dvec3(-1.0, 2.0, 3.0), .voxel_size = size, .depth = dag.depth()},
        {cells, std::move(channels)},
        CellLight(level, 1, std::move(light))};
}

/// A built-in scene, lit by the sun and the sky.
inline ColouredScene lit_sample(const std::string& name, int depth, int level) {
    const Scene mesh = make_sample(name);
    BuildOptions build_options;
    build_options.depth = depth;
    const BuildResult built = build(mesh, build_options);
    AttributeOptions options;
    options.level = level;
    LitScene scene;
    scene.objects.push_back({.dag = built.dag,
                             .grid = built.grid,
                             .attributes = build_attributes(mesh, built.dag, built.grid, options)});
    scene.lights.push_back(sun_at(0.6, 0.8));
    scene.sky = Sky::clear({0.0, 1.0, 0.0});
    LightOptions light;
    light.bounces = 1;
    light.lamp_rays = light.source_rays = 4;
    light.around_rays = 8;
    light_cells(scene, light);
    const LitObject& object = scene.objects.front();
    return {name, object.dag, object.grid, object.attributes, object.light};
}

}  // namespace octavo::test
