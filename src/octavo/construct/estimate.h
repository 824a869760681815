// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/attributes/build_attributes.h"
#include "octavo/construct/build.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// What a build will take, as far as a part of it can tell.
struct Estimate {
    int depth = 0;
    double seconds = 0.0;
    std::uint64_t dag_bytes = 0;
    std::vector<std::uint64_t> level_nodes;  // of the DAG, the root's first; those of few are 0
    std::uint64_t attribute_bytes = 0;
    std::uint64_t peak_bytes = 0;     // of memory, for the whole process, where there is no cap
    std::uint64_t least_bytes = 0;    // the least cap that spilling can keep
    std::uint64_t scratch_bytes = 0;  // of disk, if all that can spill has to
    double growth = 1.0;              // of dag_bytes with each further level

    [[nodiscard]] std::uint64_t file_bytes() const { return dag_bytes + attribute_bytes; }
};

/// Estimates a build by building some of its tiles, at random places: one in 64, or more of a grid
/// below 4096^3, up to all from 512^3 down. How the DAG grows with what is in it is taken from
/// quarters of these, and carried on. Within a quarter for the built-in scenes. Holes are not
/// looked at.
///
/// Cost: some hundredths of the build from 4096^3 on, and one pass over the triangles.
///
/// @param attributes  what is to be averaged over the surfaces as well, or null; with a cap as if
///                    AttributeSource had been made already. What pictures take that are not
///                    decoded is not known
[[nodiscard]] Estimate estimate_build(const Scene& scene, const BuildOptions& options,
                                      const AttributeOptions* attributes = nullptr);

/// @throws Error limit  where the cap cannot be kept, not even by spilling; says what resolution or
///                      cap would do
void require_memory(const Estimate& estimate, std::uint64_t max_memory_bytes);

}  // namespace octavo
