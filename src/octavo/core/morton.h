// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "octavo/core/vec.h"

namespace octavo {

/// Morton code of a cell: bit 3i of the code is bit i of x, bit 3i + 1 of y, bit 3i + 2 of z. So
/// the lowest three bits are the child index x + 2y + 4z, and codes in increasing order are the
/// cells in depth-first order. Coordinates below 2^21.
[[nodiscard]] constexpr std::uint64_t morton_encode(const uvec3& cell);

/// The cell that has this Morton code.
[[nodiscard]] constexpr uvec3 morton_decode(std::uint64_t code);

namespace detail {

/// Moves bit i of a 21-bit number to bit 3i.
constexpr std::uint64_t spread_bits_by_3(std::uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & 0x001f00000000ffff;
    x = (x | x << 16) & 0x001f0000ff0000ff;
    x = (x | x << 8) & 0x100f00f00f00f00f;
    x = (x | x << 4) & 0x10c30c30c30c30c3;
    return (x | x << 2) & 0x1249249249249249;
}

/// The inverse of spread_bits_by_3.
constexpr std::uint32_t gather_bits_by_3(std::uint64_t x) {
    x &= 0x1249249249249249;
    x = (x | x >> 2) & 0x10c30c30c30c30c3;
    x = (x | x >> 4) & 0x100f00f00f00f00f;
    x = (x | x >> 8) & 0x001f0000ff0000ff;
    x = (x | x >> 16) & 0x001f00000000ffff;
    return static_cast<std::uint32_t>((x | x >> 32) & 0x1fffff);
}

}  // namespace detail

constexpr std::uint64_t morton_encode(const uvec3& cell) {
    return detail::spread_bits_by_3(cell.x) | detail::spread_bits_by_3(cell.y) << 1 |
           detail::spread_bits_by_3(cell.z) << 2;
}

constexpr uvec3 morton_decode(std::uint64_t code) {
    return {detail::gather_bits_by_3(code), detail::gather_bits_by_3(code >> 1),
            detail::gather_bits_by_3(code >> 2)};
}

}  // namespace octavo
