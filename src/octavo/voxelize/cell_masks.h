// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

#include "octavo/core/morton.h"

/// Sets of the 4x4x4 cells of a window as 64 bits in Morton order, from what is known along an axis
/// or in a projection. All by small tables that the compiler fills in.
namespace octavo {

namespace detail {

template <class Holds>
constexpr std::uint64_t cells_where(Holds holds) {
    std::uint64_t mask = 0;
    for (std::uint32_t code = 0; code < 64; ++code)
        if (holds(morton_decode(code))) mask |= std::uint64_t{1} << code;
    return mask;
}

constexpr std::uint32_t component(const uvec3& cell, int axis) {
    return axis == 0 ? cell.x : axis == 1 ? cell.y : cell.z;
}

// [axis][first * 5 + last + 1]
inline constexpr auto kSlabs = [] {
    std::array<std::array<std::uint64_t, 25>, 3> table{};
    for (int axis = 0; axis < 3; ++axis)
        for (int first = 0; first <= 4; ++first)
            for (int last = -1; last <= 3; ++last)
                table[axis][first * 5 + last + 1] = cells_where([&](const uvec3& cell) {
                    const int x = static_cast<int>(component(cell, axis));
                    return first <= x && x <= last;
                });
    return table;
}();

// Position of axis a's two bits in a Morton code: a and a + 3.
constexpr std::uint64_t axis_bits(int axis) {
    return std::uint64_t{9} << axis;
}

// [projection]: where the four bits of a square's number stand in a cell's Morton code. The number
// is Morton order too, of the two axes that the projection looks at.
inline constexpr std::array<std::uint64_t, 3> kSquareBits = {
    axis_bits(0) | axis_bits(1), axis_bits(1) | axis_bits(2), axis_bits(2) | axis_bits(0)};

constexpr std::uint32_t square_of(int projection, std::uint32_t code) {
    std::uint32_t square = 0;
    int next = 0;
    for (int bit = 0; bit < 6; ++bit)
        if (kSquareBits[static_cast<unsigned>(projection)] >> bit & 1)
            square |= (code >> bit & 1u) << next++;
    return square;
}

// [projection][half][byte]: the cells above or below the squares of one byte
inline constexpr auto kColumns = [] {
    std::array<std::array<std::array<std::uint64_t, 256>, 2>, 3> table{};
    for (int p = 0; p < 3; ++p) {
        std::array<std::uint64_t, 16> column{};
        for (std::uint32_t code = 0; code < 64; ++code)
            column[square_of(p, code)] |= std::uint64_t{1} << code;
        for (int half = 0; half < 2; ++half)
            for (int byte = 0; byte < 256; ++byte)
                for (int bit = 0; bit < 8; ++bit)
                    if (byte >> bit & 1) table[p][half][byte] |= column[8 * half + bit];
    }
    return table;
}();

}  // namespace detail

/// Position of each cell of a window, by Morton code.
inline constexpr auto kCellOfCode = [] {
    std::array<ivec3, 64> table{};
    for (std::uint32_t code = 0; code < 64; ++code) table[code] = ivec3(morton_decode(code));
    return table;
}();

/// Of a cell of a window, by Morton code: the column along each projection that it is in, u + 4 v.
struct ColumnsOfCell {
    std::uint8_t column[4];  // the last is not used
};
inline constexpr auto kColumnsOfCell = [] {
    std::array<ColumnsOfCell, 64> table{};
    for (std::uint32_t code = 0; code < 64; ++code)
        for (int p = 0; p < 3; ++p) {
            const uvec3 cell = morton_decode(code);
            table[code].column[p] = static_cast<std::uint8_t>(
                detail::component(cell, p) + 4 * detail::component(cell, (p + 1) % 3));
        }
    return table;
}();

/// The cells with first <= coordinate <= last on this axis. first 0 to 4, last -1 to 3.
[[nodiscard]] inline std::uint64_t cells_from_to(int axis, int first, int last) {
    return detail::kSlabs[static_cast<unsigned>(axis)][static_cast<unsigned>(first * 5 + last + 1)];
}

/// The 4x4 cells with this coordinate on an axis.
[[nodiscard]] constexpr std::uint64_t cells_of_layer(int axis, std::uint32_t coordinate) {
    return detail::cells_where(
        [&](const uvec3& cell) { return detail::component(cell, axis) == coordinate; });
}

/// The cells whose shadow in a projection is one of these squares. Projection p looks at axes u = p
/// and v = p + 1 (cyclic); the bits of `squares` are in the Morton order of these axes.
[[nodiscard]] inline std::uint64_t cells_over_squares(int p, std::uint32_t squares) {
    const auto& table = detail::kColumns[static_cast<unsigned>(p)];
    return table[0][squares & 255u] | table[1][squares >> 8 & 255u];
}

}  // namespace octavo
