// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "octavo/attributes/build_attributes.h"
#include "octavo/construct/build.h"
#include "octavo/mesh/scene.h"

namespace octavo {

/// An estimated figure: what is likely, and between what it lies as far as a sample can tell.
struct Between {
    std::uint64_t least = 0, likely = 0, most = 0;
};

/// What a build will give and take, as far as a part of it can tell.
struct Estimate {
    int depth = 0;
    double sampled = 1.0;  // of the tiles: 1 where all were built

    Between voxels, dag_nodes, dag_bytes;
    std::vector<std::uint64_t> level_nodes;  // of the DAG, the root's first; those of few are 0
    std::uint64_t attribute_bytes = 0;

    double seconds = 0.0;  // on these threads, without reading the scene and writing the file

    // These are bounds. Without attributes a build that may take `peak_bytes` takes no more.
    std::uint64_t peak_bytes = 0;     // of memory, for the whole process, where there is no cap
    std::uint64_t least_bytes = 0;    // the least cap that spilling can keep
    std::uint64_t scratch_bytes = 0;  // of disk, if all that can spill has to
    double growth = 1.0;              // of dag_bytes with each further level

    /// Of an .octv file that is not compressed.
    [[nodiscard]] Between file_bytes() const {
        return {dag_bytes.least + attribute_bytes, dag_bytes.likely + attribute_bytes,
                dag_bytes.most + attribute_bytes};
    }
};

/// Estimates a build by building some of its tiles, at random places: one in 64, or more of a grid
/// below 4096^3, up to all from 512^3 down. How the number of different nodes grows with what is
/// looked at is taken from sixteenths of these, and carried on
/// (docs/adr/0060-growth-of-a-sample.md, with how far estimates were off). Holes are not looked at.
///
/// Nothing is written, but where `options` have a cap and a scratch folder: there, and it is gone
/// afterwards.
///
/// Cost: some hundredths of the build from 4096^3 on, and one pass over the triangles.
///
/// @param scene       as it will be built; held by the caller meanwhile, which counts
/// @param options     those of the build: `grid` or `depth`, `rule`, `threads`, `max_memory_bytes`,
///                    `reduce` and `progress` matter
/// @param attributes  what is to be averaged over the surfaces as well, or null; with a cap as if
///                    AttributeSource had been made already. What pictures take that are not
///                    decoded is not known
/// @throws Error      bad_argument where the options or the scene's bounds allow no grid; io;
///                    cancelled
[[nodiscard]] Estimate estimate_build(const Scene& scene, const BuildOptions& options,
                                      const AttributeOptions* attributes = nullptr);

/// Whether a DAG that takes at least so many bytes has more words than its pointers can name.
[[nodiscard]] bool beyond_pointers(double least_dag_bytes);

/// @throws Error limit  where the DAG would have more words than its pointers can name, whatever
///                      the memory; says what resolution would do
void require_words(const Estimate& estimate);

/// @throws Error limit  where the cap cannot be kept, not even by spilling; says what resolution or
///                      cap would do
void require_memory(const Estimate& estimate, std::uint64_t max_memory_bytes);

}  // namespace octavo
