// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <cstring>

/// Red, green, blue and opacity in one register, by the vectors that every compiler has which we
/// build with.
namespace octavo::detail {

typedef std::uint16_t EightWords __attribute__((vector_size(16)));
typedef std::int32_t FourInts __attribute__((vector_size(16)));
typedef float FourFloats __attribute__((vector_size(16)));

/// The four 16-bit channels of a texel, two words.
inline FourFloats texel_channels(const std::uint32_t* texel) {
    // By way of whole registers: compilers take vectors of half a register apart.
    EightWords words{};
    std::memcpy(&words, texel, 8);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    const EightWords mixed = __builtin_shufflevector(words, EightWords{}, 0, 8, 1, 9, 2, 10, 3, 11);
#else
    const EightWords mixed = __builtin_shufflevector(words, EightWords{}, 8, 0, 9, 1, 10, 2, 11, 3);
#endif
    FourInts channels;
    std::memcpy(&channels, &mixed, sizeof channels);
    return __builtin_convertvector(channels, FourFloats);
}

/// The lower halves of three numbers, and a fourth word.
inline EightWords low_words(const FourInts& numbers, std::uint16_t fourth) {
    EightWords halves;
    std::memcpy(&halves, &numbers, sizeof halves);
    const EightWords others = EightWords{} + fourth;
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    return __builtin_shufflevector(halves, others, 0, 2, 4, 8, 8, 8, 8, 8);
#else
    return __builtin_shufflevector(halves, others, 1, 3, 5, 8, 8, 8, 8, 8);
#endif
}

}  // namespace octavo::detail
