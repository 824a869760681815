// SPDX-License-Identifier: MIT
#include "octavo/construct/sampled_tiles.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "octavo/core/morton.h"

namespace octavo {

namespace {

std::uint64_t hash_of(const uvec3& tile) {
    std::uint64_t hash = tile.x + (std::uint64_t{tile.y} << 20) + (std::uint64_t{tile.z} << 40);
    hash = (hash + 1) * 0x9e3779b97f4a7c15u;
    hash = (hash ^ hash >> 29) * 0xbf58476d1ce4e5b9u;
    return (hash ^ hash >> 32) * 0x94d049bb133111ebu;
}

}  // namespace

bool TileSample::has(const uvec3& tile) const {
    return rarity == 0 || hash_of(tile) >> (64 - 2 * rarity) == part;
}

unsigned TileSample::piece_of(const uvec3& tile) const {
    return static_cast<unsigned>(hash_of(tile) << 2 * rarity >> 60);
}

std::vector<std::size_t> triangles_in_sample(const Scene& scene, const Grid& grid, int tile_depth,
                                             const TileSample& sample) {
    constexpr std::size_t kGrain = 1 << 14;
    constexpr std::uint32_t kWide = 64;  // tiles; to ask for each would take long
    constexpr double kMargin = 1e-3;     // of a tile, for what only touches it once it is rounded
    const double tiles_per_unit = std::ldexp(1.0 / grid.voxel_size, -tile_depth);
    const double tiles = std::ldexp(1.0, grid.depth - tile_depth);

    const auto is_wanted = [&](std::size_t triangle) {
        const auto [a, b, c] = scene.corners(triangle);
        const dvec3 low = (glm::min(a, glm::min(b, c)) - grid.origin) * tiles_per_unit - kMargin;
        const dvec3 high = (glm::max(a, glm::max(b, c)) - grid.origin) * tiles_per_unit + kMargin;
        // Written so that what is not a number is not wanted.
        for (int axis = 0; axis < 3; ++axis)
            if (!(low[axis] < tiles && high[axis] >= 0.0)) return false;
        const uvec3 from(glm::max(low, 0.0)), to(glm::min(high, tiles - 1.0));
        if (from == to) return sample.has(from);
        const uvec3 size = to - from + 1u;
        if (std::max({size.x, size.y, size.z}) > kWide || size.x * size.y * size.z > kWide)
            return true;
        for (std::uint32_t z = from.z; z <= to.z; ++z)
            for (std::uint32_t y = from.y; y <= to.y; ++y)
                for (std::uint32_t x = from.x; x <= to.x; ++x)
                    if (sample.has({x, y, z})) return true;
        return false;
    };

    tbb::enumerable_thread_specific<std::vector<std::size_t>> wanted;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scene.triangles.size(), kGrain),
                      [&](const auto& range) {
                          std::vector<std::size_t>& of_thread = wanted.local();
                          for (std::size_t i = range.begin(); i < range.end(); ++i)
                              if (is_wanted(i)) of_thread.push_back(i);
                      });
    std::vector<std::size_t> all;
    for (const std::vector<std::size_t>& of_thread : wanted)
        all.insert(all.end(), of_thread.begin(), of_thread.end());
    return all;
}

Scene bare_scene(const Scene& scene, const std::vector<std::size_t>& triangles) {
    Scene bare;
    bare.positions.reserve(3 * triangles.size());
    bare.triangles.reserve(triangles.size());
    for (const std::size_t i : triangles) {
        const auto first = static_cast<std::uint32_t>(bare.positions.size());
        for (const dvec3& corner : scene.corners(i)) bare.positions.push_back(corner);
        bare.triangles.push_back({first, first + 1, first + 2});
    }
    return bare;
}

SampledTiles::SampledTiles(const VoxelSource& source, const TileSample& sample) : source_(source) {
    for (std::size_t i = 0; i < source.tiles().size(); ++i) {
        if (!sample.has(morton_decode(source.tiles()[i]))) continue;
        tiles_.push_back(source.tiles()[i]);
        indices_.push_back(i);
    }
}

}  // namespace octavo
