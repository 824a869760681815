// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "octavo/dag/dag.h"
#include "octavo/trace/dag_view.h"

/// Many rays at once: one in each lane of the widest vectors that the machine has (AVX-512, AVX2,
/// SSE4, NEON; chosen at run time), straight through the words of the DAG. Tables beside it are
/// up to the caller.
///
/// The result for each ray is that of the shared text (traverse.h) to the last bit, but for
/// GridHit::steps, which is 0. One thread; callers share rays out to threads.
///
/// Rays that follow each other should start close together, like those of a pixel or of a tile of
/// pixels: they share the way down to the smallest cell that holds all their starts, and memory.
namespace octavo {

class Partitions;

/// Rays that are set up together. A stream's bundles of this many should be the close ones.
inline constexpr std::size_t kRaysPerBatch = 64;

/// How to wait for nodes: a DAG far larger than the caches is walked with more rays in flight,
/// which ask for their nodes a step ahead. Faster for the one, slower for the other. Or without
/// lanes and tables, each ray by the shared text. The same results.
enum class WideWalk { by_size, near_nodes, far_nodes, one_by_one };

/// @param hits  as long as `rays`
/// Cost         with AVX-512 a third to a sixth of as many calls of shared::trace_closest(), see
///              docs/results.md
void trace_closest_wide(const Dag& dag, std::span<const shared::GridRay> rays, shared::Stop stop,
                        std::span<shared::GridHit> hits,
                        WideWalk walk = WideWalk::by_size) noexcept;

/// shared::beam_start(), the same number, with the eight children of a cell in one test.
[[nodiscard]] float beam_start_wide(const Dag& dag, const shared::Bundle& beam, shared::Stop stop,
                                    WideWalk walk = WideWalk::by_size) noexcept;

/// @param occluded    as long as `rays`; 1 where the ray hits something, else 0
/// @param partitions  of this DAG, or null. With them rays that run alike, as those to a lamp do,
///                    take less than half of the time where walls are in their way. The same
///                    results.
void trace_any_wide(const Dag& dag, std::span<const shared::GridRay> rays, shared::Stop stop,
                    std::span<std::uint8_t> occluded, Partitions* partitions = nullptr,
                    WideWalk walk = WideWalk::by_size) noexcept;

}  // namespace octavo
