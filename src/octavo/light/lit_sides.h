// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/core/box.h"
#include "octavo/light/cell_words.h"
#include "octavo/light/lit_scene.h"
#include "octavo/light/lit_world.h"
#include "octavo/light/normal.h"

namespace octavo {

/// A side of a cell that can be seen.
struct LitSide {
    std::uint32_t cell;
    std::uint32_t direction_and_normal;  // the normal above the lowest 8 bits

    [[nodiscard]] int direction() const { return static_cast<int>(direction_and_normal & 255u); }
    [[nodiscard]] vec3 normal() const { return unpack_normal(direction_and_normal >> 8); }
};

/// The sides of consecutive cells, which are close together.
struct SideBlock {
    std::size_t first = 0;  // of the sides
    std::size_t end = 0;
    Box box;  // common space
};

/// The sides of an object's cells that can be seen: what its light is found for.
struct ObjectSides {
    std::uint32_t object = 0;
    std::size_t first_word = 0;  // of this object, in arrays of words
    std::vector<LitSide> sides;
    std::vector<SideBlock> blocks;

    [[nodiscard]] std::uint32_t word_of(const LitSide& side) const {
        return static_cast<std::uint32_t>(first_word + 6 * std::size_t{side.cell} +
                                          static_cast<std::size_t>(side.direction()));
    }
};

/// Finds them, in the order of cells, and tells `cells` which they are. Runs on the threads of the
/// caller's arena.
[[nodiscard]] ObjectSides find_sides(const LitScene& scene, const LitWorld& world,
                                     std::uint32_t object, CellWords& cells);

/// Sets the blocks' boxes by where the object stands in this world.
void place_blocks(const LitScene& scene, const LitWorld& world, ObjectSides& o);

/// What the object fills of common space: the cells that can be seen, or else its grid.
[[nodiscard]] Box object_box(const LitScene& scene, const LitWorld& world, const ObjectSides& o);

/// The same and a cell more on each side, for edges of cells that cannot be seen, and rounding.
[[nodiscard]] Box box_with_margin(const LitScene& scene, const LitWorld& world,
                                  const ObjectSides& o);

/// Voxels.
[[nodiscard]] double cell_width(const LitScene& scene, std::uint32_t object);

}  // namespace octavo
