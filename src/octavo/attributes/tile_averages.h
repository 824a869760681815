// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "octavo/attributes/attributes.h"
#include "octavo/attributes/build_attributes.h"
#include "octavo/attributes/part_sum.h"
#include "octavo/attributes/surface_sampler.h"
#include "octavo/attributes/surface_tiles.h"
#include "octavo/attributes/triangle_pieces.h"
#include "octavo/core/box.h"

namespace octavo {

/// What the cells of one tile look like, in the order of their numbers: as the bits of each
/// channel.
using TileValues = std::array<std::vector<std::uint32_t>, Attributes::kChannels>;

/// Averages triangles over the cells of one tile at a time. Scratch memory is kept from tile to
/// tile; where it is bounded, as under a memory cap, a tile of many triangles is gone over more
/// than once, each time for some of its cells, which gives the same bits.
class TileAverager {
public:
    /// All outlive this.
    /// @param make_room  called whenever some triangles have been looked at: each may have brought
    ///                   pages of temporary files into memory. Or empty
    TileAverager(const CellIndex& cells, const SurfaceTiles& triangles,
                 const SurfaceSampler& surfaces, const AttributeOptions& wanted,
                 std::function<void()> make_room);

    /// @param tile   in tiles
    /// @param range  the numbers of its cells, not empty
    void average(const uvec3& tile, const CellRange& range, TileValues& out);

private:
    using Corners = std::array<dvec3, 3>;  // in cells of the tile
    using Facet = SurfaceFacet;
    using Part = SurfacePart;
    static constexpr std::uint32_t kNone = Part::kNone;
    struct Values {  // of a cell, one for each channel
        std::uint32_t color = 0, back = 0;
        std::uint32_t emission = 0, back_emission = 0;
        std::uint32_t normal = 0, back_normal = 0;
    };

    void find_cells(const CellRange& range);
    [[nodiscard]] std::uint32_t number_of(std::uint64_t code) const;
    /// Calls visit(corners, scene_triangle) for the triangles that meet the tile.
    template <class Visit>
    void for_each_triangle(const Visit& visit) const;
    [[nodiscard]] static Facet facet_of(const TrianglePieces& pieces);
    void cut(const Corners& corners, std::size_t in_scene);
    void take_cells(std::uint32_t begin, std::uint32_t end);
    void take_fewer_cells();
    void start_parts();
    void add_part(std::uint32_t cell, std::uint32_t facet, std::uint64_t area, const Tint& tint,
                  const Glow& glow);
    void touch_bare_cells();
    void add_to(PartSum& sum, std::uint32_t part) const;
    [[nodiscard]] Values values_of_one(std::uint32_t part) const;
    [[nodiscard]] Values values_of_several(std::uint32_t first) const;
    void write(std::uint32_t cell, TileValues& out) const;

    const CellIndex& cells_;
    const SurfaceTiles& triangles_;
    const SurfaceSampler& surfaces_;
    const AttributeOptions& wanted_;
    std::function<void()> make_room_;
    int looked_at_ = 0;  // triangles since room was made
    int tile_depth_;
    uvec3 tile_{0};
    dvec3 to_tile_{0.0};  // from units of the mesh, after scaling by unit_, to cells of the tile
    double unit_;
    std::array<bool, Attributes::kChannels> kept_;
    std::size_t most_parts_;  // at a time
    bool glows_wanted_;
    bool color_alone_;                     // no normal, and nothing glows
    std::span<const std::uint8_t> srgb8_;  // of linear light in steps of 1/65535

    std::uint32_t begin_ = 0, end_ = 0;  // the cells that parts are kept of
    Box near_;                           // what has no part in these lies outside

    std::vector<std::uint32_t> spread_;  // of each number below a tile's width: bit i at bit 3i
    std::vector<std::uint64_t> masks_;   // of each block of 4x4x4 cells
    std::vector<std::uint32_t> firsts_;  // number in the tile of each block's first cell
    std::vector<std::uint32_t> blocks_;  // those that are not empty
    std::vector<std::uint32_t> codes_;   // of the cells in the tile, Morton order
    std::vector<Facet> facets_;
    // The first part of each cell from begin_ on, and behind these all others: most cells have one,
    // which is then found without a list or a sort.
    std::vector<Part> parts_;
    std::vector<Glow> glows_;  // of each part, where they are wanted
};

}  // namespace octavo
