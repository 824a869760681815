// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "octavo/core/error.h"

namespace octavo {

/// How far a long piece of work has come.
struct Progress {
    std::string_view phase;    // "voxelize", "render", ...; lives as long as the program
    std::uint64_t done = 0;    // of `total`, in the phase's own units
    std::uint64_t total = 0;   // 0 where it is not known
    std::uint64_t voxels = 0;  // found so far, where the phase counts them
};

/// Called from time to time, from one thread at a time; returns false to stop the work, which then
/// throws an Error `cancelled`. An empty function is never called.
using ProgressFunction = std::function<bool(const Progress&)>;

/// Calls the function, if there is one. @throws Error cancelled where it asks to stop
inline void report(const ProgressFunction& function, const Progress& progress) {
    if (function && !function(progress)) throw Error(Errc::cancelled, "stopped on request");
}

}  // namespace octavo
