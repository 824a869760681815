// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "octavo/construct/build.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// What a build will take, as far as coarser builds can tell.
struct Estimate {
    int depth = 0;
    double seconds = 0.0;
    std::uint64_t dag_bytes = 0;      // about the size of the file, uncompressed
    std::uint64_t peak_bytes = 0;     // of memory, for the whole process, where there is no cap
    std::uint64_t least_bytes = 0;    // the least cap that spilling can keep
    std::uint64_t scratch_bytes = 0;  // of disk, if nodes and triangles have to spill
    double growth = 1.0;              // of dag_bytes with each further level
};

/// Estimates a build by doing it twice, at an eighth and a sixteenth of the resolution, and taking
/// the growth from one to the other to go on. Surfaces make that a good guess: within a factor of
/// two for the built-in scenes. Grids of less than 64^3 are built whole.
///
/// Cost: a few hundredths of the build where voxels outnumber triangles; up to a third where they
/// do not.
[[nodiscard]] Estimate estimate_build(const Scene& scene, const BuildOptions& options);

/// @throws Error limit  where the cap cannot be kept, not even by spilling; says what resolution or
///                      cap would do
void require_memory(const Estimate& estimate, std::uint64_t max_memory_bytes);

}  // namespace octavo
