// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/construct/construct.h"

namespace octavo::cuda {

/// Reduces tiles on a CUDA device, for BuildOptions::reduce: the nodes, and so the bytes of the
/// DAG, are those of the CPU's. May be called from many threads; the device takes one tile at a
/// time.
///
/// @param device   as open_queue()
/// @throws Error   unsupported where there is no such device; called, limit and io as well
[[nodiscard]] ReduceFunction make_reducer(int device = -1);

}  // namespace octavo::cuda
