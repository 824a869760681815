// SPDX-License-Identifier: MIT
// What every harness holds the library to.
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "octavo/core/error.h"
#include "octavo/core/vec.h"

namespace octavo::fuzz {

/// Ends the process, with the promise's words, where it does not hold.
inline void require(bool condition, const char* promise) {
    if (condition) return;
    std::fprintf(stderr, "broken: %s\n", promise);
    std::abort();
}

/// Of an error that a file has caused.
inline void require_one_line(const Error& error) {
    require(error.code() != Errc::cancelled, "nobody has stopped it");
    require(std::string_view(error.what()).find('\n') == std::string_view::npos,
            "a message is one line");
}

inline bool finite(const dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace octavo::fuzz
