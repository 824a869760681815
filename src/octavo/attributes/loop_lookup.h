// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "octavo/core/vec.h"
#include "octavo/dag/dag.h"

namespace octavo {

/// The number of an occupied cell by the loop of [J]'s look-up: halve the cube, compare the
/// coordinates with the half, go down. Where [J] reads an index from the node, this counts the
/// cells beneath the siblings that it passes, one by one. Slow and plain: what CellIndex is tested
/// against.
///
/// @param level  of the cell: 0 to dag.depth()
/// Cost: visits every cell before this one; for small DAGs
[[nodiscard]] std::optional<std::uint64_t> find_cell_by_loop(const Dag& dag, int level, uvec3 cell);

}  // namespace octavo
