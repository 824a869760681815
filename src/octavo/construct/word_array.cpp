// SPDX-License-Identifier: MIT
#include "octavo/construct/word_array.h"

#include <sys/mman.h>
#include <unistd.h>

namespace octavo {

void WordArray::discard_before(std::uint64_t index) {
    const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
    const auto begin = reinterpret_cast<std::uintptr_t>(words_.get());
    const std::uintptr_t first = (begin + page - 1) / page * page;
    const std::uintptr_t last = (begin + index * sizeof(std::uint32_t)) / page * page;
    // Advice: where it is not taken, the memory comes back later, with the array.
    if (first < last) (void)madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED);
}

}  // namespace octavo
