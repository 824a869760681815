// SPDX-License-Identifier: MIT
//
// Lets one source text compile as C++20, CUDA, GLSL 4.6 and GLSL ES 3.00. The shared text is
// written in GLSL; this header, the only one with an #if, gives the other languages what they lack.
//
// A backend includes, in this order:
//     shared_text.h
//     its own  struct DagView { ...; int depth; };          depth 0: no voxel at all
//     and      uint dag_load(DagView dag, uint word);        the DAG's words, see dag/node.h
//     traverse.h, then beam.h where it wants beams
//
// OCTAVO_ARRAY(name, type) is an array in the memory of the one who runs the text, where it has one
// (not in GLSL ES): a struct of one address, whose elements are array.at[i].
//
// Rules for shared text: 32-bit types; free functions and plain structs; results by value; no
// recursion, pointers or references; explicit conversions; literals with f or u; vectors and vector
// functions by GLSL's names. A sum with a product in it goes through exact_madd().
#pragma once

#if defined(__cplusplus)

#include <bit>
#include <glm/glm.hpp>
namespace octavo::shared {
using namespace glm;
}
#if defined(__CUDACC__)
#define OCTAVO_FN __host__ __device__ inline
#else
#define OCTAVO_FN inline
#endif
#define OCTAVO_SHARED_BEGIN namespace octavo::shared {
#define OCTAVO_SHARED_END }
#define OCTAVO_PRECISE
#define OCTAVO_ARRAY(name, type) \
    struct name {                \
        type* at;                \
    };

#else

#define OCTAVO_FN
#define OCTAVO_SHARED_BEGIN
#define OCTAVO_SHARED_END
#if defined(GL_ES)
#define OCTAVO_PRECISE
#else
#define OCTAVO_PRECISE precise
#define OCTAVO_ARRAY(name, type)                                               \
    layout(buffer_reference, scalar, buffer_reference_align = 4) buffer name { \
        type at[];                                                             \
    };
#endif

#endif

OCTAVO_SHARED_BEGIN

// Number of set bits of an 8-bit mask.
OCTAVO_FN int count_bits8(uint mask) {
#if defined(__CUDA_ARCH__)
    return __popc(mask);
#elif defined(__cplusplus)
    return std::popcount(mask);
#elif defined(GL_ES)
    mask = mask - ((mask >> 1) & 0x55u);
    mask = (mask & 0x33u) + ((mask >> 2) & 0x33u);
    return int((mask + (mask >> 4)) & 0x0Fu);
#else
    return bitCount(mask);
#endif
}

// Index of the lowest set bit of a number that is not zero.
OCTAVO_FN int lowest_bit(uint mask) {
#if defined(__CUDA_ARCH__)
    return __ffs(int(mask)) - 1;
#elif defined(__cplusplus)
    return std::countr_zero(mask);
#elif defined(GL_ES)
    // A power of two is exact in a float, and its exponent is the index.
    return int((floatBitsToUint(float(mask & (~mask + 1u))) >> 23) & 255u) - 127;
#else
    return findLSB(mask);
#endif
}

// Index of the highest set bit of a mask below 2^24; of none a negative number.
OCTAVO_FN int highest_bit(uint mask) {
#if defined(__CUDA_ARCH__)
    return 31 - __clz(int(mask));
#elif defined(__cplusplus)
    return std::bit_width(mask) - 1;
#elif defined(GL_ES)
    return int(floatBitsToUint(float(mask)) >> 23) - 127;
#else
    return findMSB(mask);
#endif
}

// a * b + c with both roundings, on every backend: never fused.
OCTAVO_FN vec3 exact_madd(float a, vec3 b, vec3 c) {
#if defined(__CUDA_ARCH__)
    return vec3(__fadd_rn(__fmul_rn(a, b.x), c.x), __fadd_rn(__fmul_rn(a, b.y), c.y),
                __fadd_rn(__fmul_rn(a, b.z), c.z));
#else
    OCTAVO_PRECISE vec3 product = a * b;
    OCTAVO_PRECISE vec3 sum = product + c;
    return sum;
#endif
}

OCTAVO_SHARED_END
