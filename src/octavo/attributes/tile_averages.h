// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "octavo/attributes/attributes.h"
#include "octavo/attributes/build_attributes.h"
#include "octavo/attributes/surface_sampler.h"
#include "octavo/attributes/surface_tiles.h"

namespace octavo {

/// What the cells of one tile look like, in the order of their numbers: as the bits of each
/// channel.
using TileValues = std::array<std::vector<std::uint32_t>, Attributes::kChannels>;

/// Averages triangles over the cells of one tile at a time. Scratch memory is kept from tile to
/// tile.
class TileAverager {
public:
    /// All outlive this.
    TileAverager(const CellIndex& cells, const SurfaceTiles& triangles,
                 const SurfaceSampler& surfaces, const AttributeOptions& wanted);

    /// @param tile   in tiles
    /// @param range  the numbers of its cells, not empty
    void average(const uvec3& tile, const CellRange& range, TileValues& out);

private:
    struct Facet {  // a triangle as it is in this tile
        std::array<dvec3, 3> corners;
        std::array<std::int64_t, 3> normal;  // unit length is 2^14
        std::size_t in_scene;
        int facing;  // 2 * axis, + 1 where that component is positive
    };
    struct Part {            // of a facet, in a cell
        std::uint32_t cell;  // in the tile's order
        std::uint32_t facet;
        std::uint64_t area;  // a cell's face is 2^32
        SurfaceSample sample;
    };
    class Sum;

    void find_cells(const CellRange& range);
    [[nodiscard]] std::uint32_t number_of(const ivec3& cell) const;
    void cut(const std::array<FixedPoint, 3>& corners, std::size_t in_scene);
    void sort_parts();
    void touch_bare_cells();
    void write(std::uint32_t cell, std::span<const std::uint32_t> parts, TileValues& out) const;

    const CellIndex& cells_;
    const SurfaceTiles& triangles_;
    const SurfaceSampler& surfaces_;
    const AttributeOptions& wanted_;
    int tile_depth_;
    dvec3 to_tile_{0.0};  // from units of the mesh, after scaling by unit_, to cells of the tile
    double unit_;
    std::array<bool, Attributes::kChannels> kept_;

    std::vector<std::uint64_t> masks_;   // of each block of 4x4x4 cells
    std::vector<std::uint32_t> firsts_;  // number in the tile of each block's first cell
    std::vector<std::uint32_t> blocks_;  // those that are not empty
    std::vector<std::uint32_t> codes_;   // of the cells in the tile, Morton order
    std::vector<Facet> facets_;
    std::vector<Part> parts_;
    std::vector<std::uint32_t> part_order_;
    std::vector<std::uint32_t> part_begins_;
};

}  // namespace octavo
