// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "octavo/core/error.h"

namespace octavo {

/// How many words of 32 bits there is room for: what ids and pointers of 32 bits can name. Builds
/// have these; a test sets smaller ones, since no test has time for such a DAG.
struct WordLimits {
    std::uint64_t of_level = 0xffffffffu;           // while it grows
    std::uint64_t of_dag = std::uint64_t{1} << 32;  // once it is frozen

    /// @throws Error limit where there are more
    void check_level(std::uint64_t words) const {
        if (words > of_level) [[unlikely]]
            refuse("a level of the DAG needs", words, of_level);
    }
    void check_dag(std::uint64_t words) const {
        if (words > of_dag) refuse("the DAG needs", words, of_dag);
    }

private:
    [[noreturn]] static void refuse(const char* what, std::uint64_t words, std::uint64_t most) {
        throw Error(Errc::limit, std::string(what) + " at least " + std::to_string(words) +
                                     " words of 32 bits, and at most " + std::to_string(most) +
                                     " can be addressed: a lower resolution takes fewer");
    }
};

}  // namespace octavo
