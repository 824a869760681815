// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "octavo/attributes/cell_index.h"
#include "octavo/attributes/cell_values.h"
#include "octavo/attributes/encodings.h"
#include "octavo/mesh/color.h"

namespace octavo {

/// What the occupied cells of one level look like: base colour, emission and normal, averaged over
/// the area of the triangles inside each cell.
///
/// A cell may have two sides, where triangles in it face opposite ways: a wall thinner than a cell
/// keeps the colour of each. A look-up says where it is seen from by `towards`, a direction in grid
/// space from the surface to the eye, of any length; zero asks for the front, which is the side
/// with more area. A cell with one side looks the same from everywhere.
///
/// Nothing here changes once it is made; any number of threads may read. Copies share the values.
class Attributes {
public:
    /// What is stored for a cell, one array each; docs/file-format.md has their bits. An array that
    /// is not there has no cells.
    enum class Channel { color, back, emission, back_emission, normal, back_normal };
    static constexpr std::size_t kChannels = 6;
    static constexpr std::array<int, kChannels> kValueBits = {24, 32, 32, 32, 24, 24};

    /// None at all.
    Attributes() = default;

    /// @param channels   each empty or as long as cells.count()
    /// @param tolerance  by how much a channel of a colour may differ from the average, in 255ths
    Attributes(CellIndex cells, std::array<CellValues, kChannels> channels, int tolerance = 0)
        : cells_(std::move(cells)), channels_(std::move(channels)), tolerance_(tolerance) {}

    [[nodiscard]] const CellValues& channel(Channel which) const {
        return channels_[static_cast<std::size_t>(which)];
    }
    [[nodiscard]] bool has(Channel which) const { return !channel(which).words().empty(); }
    [[nodiscard]] bool has_color() const { return has(Channel::color); }
    [[nodiscard]] bool has_emission() const { return has(Channel::emission); }
    [[nodiscard]] bool has_normal() const { return has(Channel::normal); }
    [[nodiscard]] bool empty() const { return !has_color() && !has_emission() && !has_normal(); }

    [[nodiscard]] int level() const { return cells_.level(); }
    [[nodiscard]] const CellIndex& cells() const { return cells_; }
    [[nodiscard]] int tolerance() const { return tolerance_; }

    // By number, below cells().count(); what is not there is black, or the zero vector.

    [[nodiscard]] bool two_sided(std::uint64_t cell) const {
        return has(Channel::back) && channel(Channel::back).get(cell) != 0;
    }
    /// Whether this is the back of the cell.
    [[nodiscard]] bool seen_from_behind(std::uint64_t cell, const vec3& towards) const;
    [[nodiscard]] Rgb8 color(std::uint64_t cell, const vec3& towards) const;  // sRGB
    [[nodiscard]] vec3 emission(std::uint64_t cell, const vec3& towards) const;
    [[nodiscard]] vec3 normal(std::uint64_t cell, const vec3& towards) const;  // world; unit length

    // By place. A cell finer than level() has what its parent of that level has; a coarser one the
    // average of up to 16 of its cells. None where the cell is empty.

    /// @param path   integer coordinates at `level`, as a Hit has them
    [[nodiscard]] std::optional<Rgb8> color(const uvec3& path, int level,
                                            const vec3& towards = vec3(0.0f)) const;
    /// The same in linear light, an average without the rounding to 8 bits.
    [[nodiscard]] std::optional<vec3> albedo(const uvec3& path, int level,
                                             const vec3& towards = vec3(0.0f)) const;
    [[nodiscard]] std::optional<vec3> emission(const uvec3& path, int level,
                                               const vec3& towards = vec3(0.0f)) const;
    [[nodiscard]] std::optional<vec3> normal(const uvec3& path, int level,
                                             const vec3& towards = vec3(0.0f)) const;

    /// The cell that holds a point of grid space. A point on the border of an empty cell finds the
    /// occupied one across it, up to a thousandth of a cell away: no point of a surface is black
    /// because of its last digits.
    [[nodiscard]] std::optional<std::uint64_t> cell_at(const dvec3& grid_point) const;
    [[nodiscard]] std::optional<Rgb8> color(const dvec3& grid_point,
                                            const vec3& towards = vec3(0.0f)) const;

    /// Many look-ups, on all threads of the calling arena.
    struct Query {
        uvec3 path{0};
        int level = 0;
        vec3 towards{0.0f};
    };
    /// @param out  as long as queries: the colour and 255, or zeros where the cell is empty
    void colors(std::span<const Query> queries, std::span<Rgba8> out) const;

private:
    /// The cells to look at for a path: at most 16, evenly chosen.
    template <class Visit>
    void for_some_cells(const uvec3& path, int level, const Visit& visit) const;

    CellIndex cells_;
    std::array<CellValues, kChannels> channels_;
    int tolerance_ = 0;
};

/// The bits of Channel::back: the colour, the direction of the front, and a one.
[[nodiscard]] constexpr std::uint32_t pack_back(std::uint32_t rgb8, std::uint32_t front) {
    return rgb8 | front << 24 | 1u << 31;
}
[[nodiscard]] constexpr std::uint32_t front_direction_of_back(std::uint32_t back) {
    return back >> 24 & 127u;
}

}  // namespace octavo
