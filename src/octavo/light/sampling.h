// SPDX-License-Identifier: MIT
//
// Where a pixel's rays go: deterministic, well spread, different in each pixel. Shared text:
// include after trace/traverse.h. Directions may differ between backends in the last bits (sqrt,
// normalize).
//
// Sobol's first two dimensions with Owen's scrambling by hash: Burley, "Practical Hash-based Owen
// Scrambling", JCGT 2020. A pixel that needs more dimensions takes the sequence again, shuffled.
#pragma once

OCTAVO_SHARED_BEGIN

// Mixes all bits; constants found by Wellons' search for a low bias (2018).
OCTAVO_FN uint mix_bits(uint x) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

OCTAVO_FN uint pixel_seed(uint x, uint y, uint frame) {
    return mix_bits(x + mix_bits(y + mix_bits(frame)));
}

// The seeds of a pixel's rays to its n-th lamp, and of those over the hemisphere.
OCTAVO_FN uint lamp_seed(uint pixel_seed, int n) {
    return pixel_seed ^ (0x02e5be93u + 0x9e3779b9u * uint(n));
}
OCTAVO_FN uint hemisphere_seed(uint pixel_seed) {
    return pixel_seed ^ 0x68bc21ebu;
}

OCTAVO_FN uint reverse_bits(uint x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

// Permutes numbers so that bit i of the result depends on bits 0 to i only: Owen's scrambling of
// the reversed number. The permutation is Laine's and Karras', with Burley's constants.
OCTAVO_FN uint scramble_upwards(uint x, uint seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

// A fraction in [0, 1): the high 24 bits, exact in a float.
OCTAVO_FN float to_fraction(uint x) {
    return float(x >> 8) * (1.0f / 16777216.0f);
}

// Sample `index` of a sequence; every seed has its own. Any power of two of them from index 0 on
// fill [0, 1) evenly.
OCTAVO_FN float sample_1d(uint index, uint seed) {
    uint shuffled = scramble_upwards(reverse_bits(index), mix_bits(seed));
    return to_fraction(reverse_bits(scramble_upwards(reverse_bits(shuffled), seed)));
}

// Sobol's second dimension; the first is the index with its bits reversed.
OCTAVO_FN uint sobol_second(uint index) {
    uint sum = 0u;
    uint column = 0x80000000u;
    for (uint bits = index; bits != 0u; bits >>= 1) {
        if ((bits & 1u) != 0u) sum ^= column;
        column ^= column >> 1;
    }
    return sum;
}

// The same in the unit square.
OCTAVO_FN vec2 sample_2d(uint index, uint seed) {
    return vec2(
        to_fraction(reverse_bits(scramble_upwards(index, mix_bits(seed)))),
        to_fraction(reverse_bits(scramble_upwards(reverse_bits(sobol_second(index)), seed))));
}

// An order of samples of sample_2d() that all seeds share. Of 4^m samples, from a multiple of 4^m
// on, each square of a grid of 2^m x 2^m has one, and here they come square by square: so pixels
// that go through theirs together look the same way at the same time, each to its own point of
// the square. Three tables of nibbles, as m is at most 3.
struct SquareOrder {
    int m;
    uint columns;  // of a column of squares: the low m bits of its samples' indices
    uint rows;     // of a row: the first m bits of Sobol's second dimension, reversed
    uint high;     // of such m bits: the next m bits of the index that give them
};

OCTAVO_FN uint nibble(uint nibbles, uint number) {
    return (nibbles >> (4u * number)) & 15u;
}
OCTAVO_FN uint leading_bits(uint x, int count) {
    return (x >> 1) >> (31 - count);
}

OCTAVO_FN SquareOrder square_order(int m, uint seed) {
    SquareOrder order;
    order.m = m;
    order.columns = 0u;
    order.rows = 0u;
    order.high = 0u;
    for (uint i = 0u; i < (1u << m); i += 1u) {
        uint column = leading_bits(reverse_bits(scramble_upwards(i, mix_bits(seed))), m);
        uint row = leading_bits(reverse_bits(scramble_upwards(i, seed)), m);
        order.columns |= i << (4u * column);
        order.rows |= i << (4u * row);
        order.high |= i << (4u * leading_bits(sobol_second(i << m), m));
    }
    return order;
}

// The sample of the 4^m from `first` on, a multiple of 4^m, that lies in this square: `square` has
// m bits of the row and m of the column.
OCTAVO_FN uint sample_in_square(SquareOrder order, uint first, uint square) {
    uint low = first | nibble(order.columns, square & ((1u << order.m) - 1u));
    uint second = reverse_bits(nibble(order.rows, square >> order.m));
    return low | (nibble(order.high, leading_bits(second ^ sobol_second(low), order.m)) << order.m);
}

// Cosine and sine of this many turns, 0 to 1, to 3e-7: Taylor's series on an eighth of the circle.
// GPUs may miss by 5e-4, and each by another number.
OCTAVO_FN vec2 circle_point(float turns) {
    float quarters = floor(4.0f * turns + 0.5f);
    float angle = (4.0f * turns - quarters) * 1.5707963f;
    vec3 square = vec3(angle * angle);
    vec3 c = exact_madd(square.x, vec3(2.4801587e-5f), vec3(-1.3888889e-3f));
    c = exact_madd(c.x, square, vec3(4.1666667e-2f));
    c = exact_madd(c.x, square, vec3(-0.5f));
    c = exact_madd(c.x, square, vec3(1.0f));
    vec3 s = exact_madd(square.x, vec3(2.7557319e-6f), vec3(-1.9841270e-4f));
    s = exact_madd(s.x, square, vec3(8.3333333e-3f));
    s = exact_madd(s.x, square, vec3(-1.6666667e-1f));
    s = exact_madd(s.x, square, vec3(1.0f)) * angle;
    int quarter = int(quarters) & 3;
    vec2 point = (quarter & 1) == 0 ? vec2(c.x, s.x) : vec2(-s.x, c.x);
    return quarter < 2 ? point : -point;
}

// A point of the unit disc, evenly spread.
OCTAVO_FN vec2 disc_point(vec2 square) {
    return sqrt(square.x) * circle_point(square.y);
}

// From the frame whose z axis is the unit vector n.
OCTAVO_FN vec3 from_frame(vec3 n, vec3 v) {
    vec3 other = abs(n.x) < 0.6f ? vec3(1.0f, 0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f);
    vec3 x_axis = normalize(cross(other, n));
    return v.x * x_axis + v.y * cross(n, x_axis) + v.z * n;
}

// A direction of the hemisphere about n, by the cosine: the disc lifted on to the sphere.
OCTAVO_FN vec3 cosine_direction(vec3 n, vec2 square) {
    vec2 disc = disc_point(square);
    return from_frame(n, vec3(disc, sqrt(max(0.0f, 1.0f - dot(disc, disc)))));
}

OCTAVO_SHARED_END
