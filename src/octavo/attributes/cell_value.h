// SPDX-License-Identifier: MIT
//
// What is stored for an occupied cell, for every backend: CellValues::get(). Shared text: see
// trace/shared_text.h. A backend includes before it
//     its own  struct ValueView { ...; };          see attributes/cell_values.h for the words
//     and      uint value_load(ValueView values, uint word);
#pragma once

OCTAVO_SHARED_BEGIN

// `count` bits, 0 to 32, from a bit offset behind a word.
OCTAVO_FN uint value_bits(ValueView values, uint word, uint offset, uint count) {
    if (count == 0u) return 0u;
    uint at = word + offset / 32u;
    uint shift = offset % 32u;
    uint low = value_load(values, at) >> shift;
    if (shift + count > 32u) low |= value_load(values, at + 1u) << (32u - shift);
    return count == 32u ? low : low & ((1u << count) - 1u);
}

// The value of the cell with this number.
OCTAVO_FN uint cell_value(ValueView values, uint cell) {
    uint block = value_load(values, 2u + cell / 256u);
    if (block == 0u) return 0u;
    uint width = value_load(values, 0u);
    uint form = value_load(values, block);
    uint index_bits = form & 255u;
    uint in_block = cell % 256u;
    if (index_bits == 255u) return value_bits(values, block + 1u, in_block * width, width);
    uint index =
        value_bits(values, block + 1u, (form >> 8) * width + in_block * index_bits, index_bits);
    return value_bits(values, block + 1u, index * width, width);
}

// RGB9E5, see encodings.h. The power of two is made of its bits, so that it is exact everywhere.
OCTAVO_FN vec3 unpack_rgb9e5(uint value) {
    float scale = uintBitsToFloat(((value >> 27) + 103u) << 23);
    return scale *
           vec3(float(value & 511u), float((value >> 9) & 511u), float((value >> 18) & 511u));
}

OCTAVO_SHARED_END
