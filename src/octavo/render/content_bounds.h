// SPDX-License-Identifier: MIT
#pragma once

#include "octavo/core/box.h"
#include "octavo/core/grid.h"
#include "octavo/dag/dag.h"

namespace octavo {

/// The smallest box, to a 256th of the grid, that holds all voxels; world space, empty for an empty
/// DAG. Cost: at most 2^24 cells, far fewer for surfaces.
[[nodiscard]] Box content_bounds(const Dag& dag, const Grid& grid);

/// content_bounds(); those of the grid where there is no voxel.
[[nodiscard]] Box framed_box(const Dag& dag, const Grid& grid);

}  // namespace octavo
