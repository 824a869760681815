// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "octavo/attributes/cell_values_writer.h"
#include "octavo/light/lit_scene.h"
#include "octavo/render/render_lit.h"
#include "support/small_dags.h"

/// Rooms of voxels, one colour each, whose light is known.
namespace octavo::test {

/// The octal tree of a set of voxels that any cube may hold some of.
inline Dag dag_of_voxels(int depth, const std::function<bool(const dvec3& centre)>& voxel) {
    return dag_of(
        depth, [](const uvec3&, std::uint32_t) { return true; },
        [&](const uvec3& v) { return voxel(dvec3(v) + 0.5); });
}

/// A box about the middle of the grid, turned about y. Its walls are `thick` voxels: each is the
/// digital plane that no step between neighbours, diagonal ones too, can cross.
///
/// @return  below 0 inside, 0 to below `thick` in a wall
inline double box_depth(int depth, double half, double degrees, const dvec3& centre) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const dvec3 p = centre - 0.5 * std::ldexp(1.0, depth);
    const double c = std::cos(angle), s = std::sin(angle), wide = std::abs(c) + std::abs(s);
    return std::max({(std::abs(c * p.x + s * p.z) - half) / wide,
                     (std::abs(c * p.z - s * p.x) - half) / wide, std::abs(p.y) - half});
}
inline Dag sealed_box(int depth, double half, double degrees, double thick) {
    return dag_of_voxels(depth, [&](const dvec3& p) {
        const double d = box_depth(depth, half, degrees, p);
        return d >= 0.0 && d < thick;
    });
}

/// Attributes of a level: every cell of this sRGB grey, and shining by a function of its cell.
inline Attributes grey(const Dag& dag, int level, std::uint8_t value,
                       const std::function<float(const uvec3&)>& emission = {}) {
    const CellIndex cells(dag, level);
    CellValuesWriter colors(24, 0), emissions(32, 0);
    cells.for_each({0, cells.count()}, [&](std::uint64_t, const uvec3& at) {
        const std::uint32_t color = pack_rgb8({value, value, value});
        colors.append(std::span(&color, 1));
        const std::uint32_t light = emission ? pack_rgb9e5(vec3(emission(at))) : 0u;
        emissions.append(std::span(&light, 1));
    });
    std::array<CellValues, Attributes::kChannels> channels;
    channels[0] = std::move(colors).finish();
    if (emission) channels[2] = std::move(emissions).finish();
    return {cells, std::move(channels)};
}

inline Grid unit_grid(int depth) {
    return {.origin = dvec3(0.0), .voxel_size = 1.0, .depth = depth};
}

inline RenderOptions small_picture(const dvec3& eye, const dvec3& target, int samples) {
    RenderOptions options;
    options.width = 32;
    options.height = 24;
    options.samples = samples;
    options.camera = look_at(eye, target, {0, 1, 0}, 1.2);
    return options;
}

inline float greatest_channel(const Image& image) {
    float most = 0.0f;
    for (const vec3& c : image.color) most = std::max({most, c.r, c.g, c.b});
    return most;
}
inline double mean_green(const Image& image) {
    double sum = 0.0;
    for (const vec3& c : image.color) sum += static_cast<double>(c.g);
    return sum / static_cast<double>(image.color.size());
}

}  // namespace octavo::test
