// SPDX-License-Identifier: MIT
#pragma once

namespace octavo {

/// Starts to fetch the cache line of a place, which need not be there.
///
/// Not __builtin_prefetch alone: GCC 12 takes a function that only prefetches for one without
/// effect, and drops the calls of it that it has not put in line by then. The empty statement is an
/// effect to it, and no instruction.
inline void prefetch_line(const void* place) {
    __builtin_prefetch(place);
    asm volatile("");
}

}  // namespace octavo
