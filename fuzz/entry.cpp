// SPDX-License-Identifier: MIT
// libFuzzer's side of one harness: OCTAVO_HARNESS is its name.
#include <algorithm>
#include <cstring>

#include "harness.h"

#define OCTAVO_CONCATENATE(a, b) a##b
#define OCTAVO_RUN(name) OCTAVO_CONCATENATE(run_, name)

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    octavo::fuzz::OCTAVO_RUN(OCTAVO_HARNESS)({data, size});
    return 0;
}

#ifdef OCTAVO_MUTATE_OCTV
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
    if (seed % 16 == 0) return LLVMFuzzerMutate(data, size, max_size);
    const auto mutated = octavo::fuzz::mutate_octv({data, size}, seed, LLVMFuzzerMutate);
    if (mutated.size() > max_size) return size;
    std::copy(mutated.begin(), mutated.end(), data);
    return mutated.size();
}
#endif
