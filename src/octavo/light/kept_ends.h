// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "octavo/core/box.h"
#include "octavo/light/cell_words.h"
#include "octavo/light/lit_world.h"

namespace octavo {

/// An object that has moved, to those who look around: where it was and where it is. Common space.
struct MovedObject {
    std::uint32_t object = 0;
    Box before, after;  // a little larger than it
};

/// Where the rays of one side end that a moved object does not touch: where they ended before it
/// moved, as their row of words tells. All words are those of rays that were traced before the
/// move.
///
/// A ray is traced again if it met the object, or meets the box around it now; if it met a cell
/// that shines, as what that sends is not in its word; or what has no word. If the point where rays
/// start may lie elsewhere now, as the object is or was near, all of them are.
class KeptEnds {
public:
    enum class End : std::uint8_t { unknown, dark, open };

    KeptEnds(const MovedObject& moved, const CellWords& words);

    /// Takes the words of a side. @return whether any ray of it must be traced again by its word
    bool begin(std::span<const std::uint32_t> row);

    /// Whether no ray that starts in a ball can reach the object, where each goes to the side of
    /// the plane through its start that `normal` looks to. Common space.
    /// @param middle, radius  the ball: of all starts, and the lines by which they are found
    /// @param normal          unit length
    [[nodiscard]] bool out_of_sight(const dvec3& middle, double radius, const vec3& normal) const;

    /// Rays start here. @param reach  how far from it the lines go by which the place is found
    void start(const dvec3& point, double reach);

    /// @param number  of a ray over the hemisphere, which goes from the last start() this way
    [[nodiscard]] End end(std::uint32_t number, const vec3& direction) const;

private:
    [[nodiscard]] End end_by_word(std::uint32_t word) const;

    const MovedObject& moved_;
    const CellWords& words_;
    std::uint32_t first_word_, end_word_;  // of the object
    std::span<const std::uint32_t> row_;
    bool near_ = false;
    vec3 low_{0.0f}, high_{0.0f}, centre_{0.0f};  // of the box, from the start
    float beyond_ = 0.0f;  // square of the way to the ball around it: of the tangents' length
};

}  // namespace octavo
